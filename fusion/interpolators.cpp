#include "fusion/interpolators.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "estimation/chosen_rows.h"
#include "estimation/in_parallel.h"
#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using machine::NetworkBias;
using simulation::PlateSetup;
using simulation::SimulatedRun;

constexpr double kNothing = 1e-12;         // m or rad: a function below it is zero
constexpr double kSharpness = 0.1;         // of kLearned: noise of the values that are learned
constexpr double kWeights = 3.0;           // prior of the inputs of a neuron
constexpr double kOutputs = 10.0;          // prior of its output, of the function's largest value
constexpr std::size_t kMostStations = 40;  // of an axis, at most

// x: the coefficients of one network.
class NetworkResidual : public estimation::Residual {
 public:
  NetworkResidual(machine::ErrorFunction function, std::vector<double> stations, VectorXd values)
      : function_(std::move(function)),
        stations_(std::move(stations)),
        values_(std::move(values)) {}

  Index Rows() const override { return values_.size(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    machine::ErrorFunction function = function_;
    function.SetCoefficients(x);
    for (Index i = 0; i < values_.size(); ++i) {
      double* const gradient = jacobian == nullptr ? nullptr : jacobian->row(i).data();
      values[i] = function.Evaluate(stations_[i], nullptr, gradient) - values_[i];
    }
  }

 private:
  machine::ErrorFunction function_;
  std::vector<double> stations_;
  VectorXd values_;
};

// The neurons of a network before it has learned: spread over the travel, without output.
estimation::ParameterBlock Neurons(const machine::Travel& travel, int neurons, NetworkBias bias,
                                   double gain, double output) {
  estimation::ParameterBlock block("network", {}, {});
  const auto add = [&](const char* name, int q, double start, double sd) {
    block.entries.push_back(
        {.name = fmt::format("{}{}", name, q), .nominal = start, .prior_sd = sd});
  };
  for (int q = 0; q < neurons; ++q) {
    const double place = travel.first + (travel.last - travel.first) * (q + 0.5) / neurons;
    const double v = bias == NetworkBias::kWithBias ? 1.0 : 1.0 + q;
    add("v", q, v, kWeights);
    if (bias == NetworkBias::kWithBias) add("b", q, -gain * v * place, kWeights);
    add("w", q, 0.0, output);
  }
  if (bias == NetworkBias::kWithBias) add("w", -1, 0.0, output);
  return block;
}

class Teacher {
 public:
  Teacher(const machine::VolumetricModel& model, int axis, int motion, NetworkBias bias)
      : axis_(axis), motion_(motion), bias_(bias), travel_(model.travels()[At(axis)]) {
    for (const machine::Travel& travel : model.travels()) {
      longest_ = std::max(longest_, travel.last - travel.first);
    }
    accepted_ = motion < 3 ? kLearned : kLearned / longest_;
  }

  struct Lesson {
    machine::SharedForm form;
    VectorXd coefficients;
    double rms;  // of the function's values
    int cycles;
  };

  // Grows until the rms is accepted; the best of all sizes.
  Lesson Learn(const std::vector<double>& stations, const VectorXd& values) const {
    std::optional<Lesson> best;
    for (int neurons = 1; neurons <= kMostNeurons; ++neurons) {
      const std::optional<Lesson> lesson = Learn(neurons, stations, values);
      if (lesson && (!best || lesson->rms < best->rms)) best = lesson;
      if (best && best->rms <= accepted_) break;
    }
    if (best) return *best;
    throw NumericalError(fmt::format("no network learned {} in {} steps; keep to the B-spline",
                                     machine::MotionName(axis_, motion_), kMostCycles));
  }
  double InMetres(double rms) const { return rms * kLearned / accepted_; }

 private:
  static std::size_t At(int axis) { return axis; }

  std::optional<Lesson> Learn(int neurons, const std::vector<double>& stations,
                              const VectorXd& values) const {
    const double gain = 2.0 / (travel_.last - travel_.first);
    const auto form = machine::MakeTanhNetwork(neurons, gain, bias_);
    estimation::Problem problem;
    const auto network = problem.Add(
        Neurons(travel_, neurons, bias_, gain, kOutputs * values.cwiseAbs().maxCoeff()));
    problem.Add(problem.AddSource("stations"),
                std::make_shared<NetworkResidual>(
                    machine::ErrorFunction(axis_, motion_, form, travel_), stations, values),
                {network}, kSharpness * accepted_);
    try {
      const auto result = problem.Solve({.max_iterations = kMostCycles, .settled = 1e-2});
      const auto& source = result.sources.front();
      return Lesson{form, result.blocks.front().Values(), source.rms * kSharpness * accepted_,
                    result.iterations};
    } catch (const NumericalError&) {  // not converged: another size may
      return std::nullopt;
    }
  }

  int axis_, motion_;
  NetworkBias bias_;
  machine::Travel travel_;
  double longest_ = 0.0, accepted_ = 0.0;
};

// The fold in which each hole is left out: the holes of each plate in order of first appearance.
class Folds {
 public:
  Folds(const std::vector<PlateSetup>& setups, int folds) {
    std::map<std::string, int> holes;
    for (const PlateSetup& setup : setups) {
      for (const int hole : setup.holes) {
        const auto [at, is_new] = fold_.try_emplace({setup.plate, hole}, 0);
        if (is_new) at->second = holes[setup.plate]++ % folds;
      }
    }
  }

  // The rows of the residual of a set-up whose holes are left out, or not, in a fold.
  std::vector<Index> Rows(const PlateSetup& setup, int fold, bool left_out) const {
    std::vector<Index> rows;
    for (std::size_t i = 0; i < setup.holes.size(); ++i) {
      if ((fold_.at({setup.plate, setup.holes[i]}) == fold) != left_out) continue;
      rows.push_back(2 * i);
      rows.push_back(2 * i + 1);
    }
    return rows;
  }

 private:
  std::map<std::pair<std::string, int>, int> fold_;
};

// The parameters of a run: those of the machine from `model`, the others from `fit`.
VectorXd InputsOf(const SimulatedRun& run, const machine::VolumetricModel& model,
                  const estimation::Result& fit) {
  const auto own = run.blocks.begin() + model.Blocks().size();
  const VectorXd others = ValuesFound(fit, {own, run.blocks.end()});
  VectorXd x(model.ParameterCount() + others.size());
  x << model.Parameters(), others;
  return x;
}

double HeldOutRms(const machine::Machine& machine, const machine::VolumetricModel& model,
                  const std::vector<PlateSetup>& setups, const Folds& folds, int fold,
                  const estimation::Result& fit) {
  double squares = 0.0, holes = 0.0;
  for (const PlateSetup& setup : setups) {
    const SimulatedRun run = simulation::SimulatePlate(model, machine.reference, setup);
    VectorXd values(run.residual->Rows());
    run.residual->Evaluate(InputsOf(run, model, fit), values, nullptr);
    const std::vector<Index> rows = folds.Rows(setup, fold, true);
    for (const Index row : rows) squares += std::pow(setup.u_probing * values[row], 2);
    holes += rows.size() / 2.0;
  }
  return std::sqrt(squares / holes);
}

estimation::Result FitWithout(const machine::Machine& machine, double smoothness,
                              const std::vector<PlateSetup>& setups, const Folds& folds, int fold) {
  const machine::VolumetricModel model = UnknownMachine(machine);
  std::vector<SimulatedRun> runs;
  for (const PlateSetup& setup : setups) {
    std::vector<Index> rows = folds.Rows(setup, fold, false);
    if (rows.size() < 6) {
      throw InputError(fmt::format("{}: {} holes are left when some are held out; hold out fewer",
                                   setup.points.name, rows.size() / 2));
    }
    SimulatedRun& run =
        runs.emplace_back(simulation::SimulatePlate(model, machine.reference, setup));
    run.residual = std::make_shared<estimation::ChosenRows>(run.residual, std::move(rows));
  }
  return simulation::SolveLinkage(
      MakeMachineProblem(machine, model, MachinePrior(machine, model, smoothness), runs), 0, false);
}

// Adds the networks that were learned, each at its worst.
void AddTo(Learning& all, const Learning& more) {
  all.rms = std::max(all.rms, more.rms);
  all.cycles = std::max(all.cycles, more.cycles);
  all.neurons = std::max(all.neurons, more.neurons);
}

// A function of the machine as a network, where there is one.
struct Taught {
  std::optional<Teacher::Lesson> lesson;
  Learning learning;
};

Taught TaughtBy(const machine::VolumetricModel& model, int axis, int motion,
                const std::vector<double>& at, NetworkBias bias) {
  VectorXd values(at.size());
  for (Index i = 0; i < values.size(); ++i) {
    values[i] = model.Function(axis, motion).Evaluate(at[i]);
  }
  Taught taught;
  if (values.size() == 0 || values.cwiseAbs().maxCoeff() < kNothing) return taught;
  const Teacher teacher(model, axis, motion, bias);
  taught.lesson = teacher.Learn(at, values);
  const int size = (taught.lesson->form->size() + 1) / (bias == NetworkBias::kWithBias ? 3 : 2);
  taught.learning = {.rms = teacher.InMetres(taught.lesson->rms),
                     .cycles = taught.lesson->cycles,
                     .neurons = size};
  return taught;
}

// The checks with one fold held out.
void CheckFold(const machine::Machine& machine, double smoothness,
               const std::vector<PlateSetup>& setups, const Folds& split, int fold,
               std::vector<InterpolatorCheck>& checks) {
  const estimation::Result fit = FitWithout(machine, smoothness, setups, split, fold);
  machine::VolumetricModel model = UnknownMachine(machine);
  model.SetParameters(ValuesFound(fit, model.Blocks()));
  const auto stations = StationsOf(setups);
  for (InterpolatorCheck& check : checks) {
    const NetworkBias bias =
        check.name == "network" ? NetworkBias::kAsPrinted : NetworkBias::kWithBias;
    const machine::VolumetricModel interpolated =
        check.name == "b-spline" ? model : AsNetworks(model, stations, bias, &check.learning);
    check.held_out = HeldOutRms(machine, interpolated, setups, split, fold, fit);
  }
}

}  // namespace

machine::VolumetricModel AsNetworks(const machine::VolumetricModel& model,
                                    const std::array<std::vector<double>, machine::kAxes>& stations,
                                    NetworkBias bias, Learning* learning) {
  machine::VolumetricModel networks(model.chain(), model.travels());
  networks.SetSquareness(model.squareness());
  constexpr std::size_t kFunctions = machine::kAxes * machine::kMotions;
  std::array<std::array<Taught, machine::kMotions>, machine::kAxes> taught;
  estimation::InParallel(kFunctions, [&](std::size_t function) {
    const int axis = static_cast<int>(function) / machine::kMotions,
              motion = static_cast<int>(function) % machine::kMotions;
    taught[axis][motion] = TaughtBy(model, axis, motion, stations[axis], bias);
  });
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const auto& [lesson, of_one] = taught[axis][motion];
      if (!lesson) continue;
      networks.SetForm(axis, motion, lesson->form);
      networks.SetCoefficients(axis, motion, lesson->coefficients);
      if (learning != nullptr) AddTo(*learning, of_one);
    }
  }
  return networks;
}

std::array<std::vector<double>, machine::kAxes> StationsOf(const std::vector<PlateSetup>& setups) {
  constexpr double kApart = 1e-4;  // m: nearer ones are one station
  std::array<std::vector<double>, machine::kAxes> stations;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    std::map<long, double> places;
    for (const PlateSetup& setup : setups) {
      for (const double at : setup.points.axes.row(axis))
        places.emplace(std::lround(at / kApart), at);
    }
    const std::size_t step = places.size() / kMostStations + 1;
    std::size_t i = 0;
    for (const auto& [key, at] : places) {
      if (i++ % step == 0) stations[axis].push_back(at);
    }
  }
  return stations;
}

std::vector<InterpolatorCheck> CompareInterpolators(const machine::Machine& machine,
                                                    double smoothness,
                                                    const std::vector<PlateSetup>& setups,
                                                    int folds) {
  std::vector<InterpolatorCheck> checks{{"b-spline"}, {"network"}, {"network with bias"}};
  const Folds split(setups, folds);
  std::vector<std::vector<InterpolatorCheck>> of_fold(folds, checks);
  estimation::InParallel(of_fold.size(), [&](std::size_t fold) {
    CheckFold(machine, smoothness, setups, split, static_cast<int>(fold), of_fold[fold]);
  });
  for (const auto& of_one : of_fold) {
    for (std::size_t i = 0; i < checks.size(); ++i) {
      checks[i].held_out += of_one[i].held_out / folds;
      AddTo(checks[i].learning, of_one[i].learning);
    }
  }
  return checks;
}

}  // namespace abbe::fusion
