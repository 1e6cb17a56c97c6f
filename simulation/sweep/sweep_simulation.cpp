#include "simulation/sweep/sweep_simulation.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "estimation/dual_number.h"
#include "estimation/extended_residual.h"
#include "failure/failure.h"
#include "simulation/axes_in_travel.h"
#include "simulation/sweep/form_of_target.h"
#include "simulation/sweep/sweep_reading.h"
#include "simulation/sweep/sweep_response.h"
#include "simulation/trace_columns.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using estimation::ParameterBlock;

constexpr double kTargetTilt = 1e-3;  // rad: how well a target is aligned before a sweep
constexpr std::array<const char*, kProbes> kLetters{"a", "b", "c", "d", "e"};
const estimation::PrintUnit kRelative{"", 1.0};

// The numbers of one reading: [six motions of the swept axis | squareness | Circumstances].
constexpr int kLocal = 24;

template <typename T, typename Vector>
Circumstances<T> Unpack(const Vector& local) {
  return {local.template segment<2>(9),  local[11],
          local.template segment<3>(12), local.template segment<3>(15),
          local.template segment<3>(18), local.template segment<3>(21)};
}

template <typename T, typename Vector>
machine::MotionErrors<T> ErrorsOf(int axis, const Vector& local) {
  machine::MotionErrors<T> errors;
  errors.axes[axis] = local.template segment<6>(0);
  errors.squareness = local.template segment<3>(6);
  return errors;
}

class SweepResidual : public Responsive {
 public:
  SweepResidual(const machine::VolumetricModel& model, SweepPlan plan,
                const SweepInstrument& instrument, SweepRun run)
      : plan_(std::move(plan)), run_(std::move(run)) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      functions_.push_back(model.Function(plan_.axis, motion));
      coefficients_ += functions_.back().size();
    }
    noise_ = std::make_shared<const FaceNoise>(FaceNoiseOf(plan_, instrument, run_));
  }

  Index Rows() const override { return kProbes * run_.rows(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    if (jacobian != nullptr) jacobian->setZero();
    const std::vector<machine::ErrorFunction> functions = FunctionsAt(x);
    const VectorXd shared = x.tail(x.size() - coefficients_);
    for (Index row = 0; row < run_.rows(); ++row) {
      if (jacobian == nullptr) {
        Rows<double>(functions, shared, row, values, nullptr);
      } else {
        Rows<estimation::DualNumber<kLocal>>(functions, shared, row, values, jacobian);
      }
    }
    if (run_.steps.cols() > 0) AddSlopes(functions, shared, values, jacobian);
    WhitenRows(*noise_, values);
    if (jacobian != nullptr) WhitenRows(*noise_, *jacobian);
  }

  std::shared_ptr<const Response> At(const VectorXd& x) const override;

  // Beside `form`, which the noise then does not contain.
  FormApart Apart(SweepInstrument instrument, FormOfTarget form) const {
    auto without = std::make_shared<SweepResidual>(*this);
    instrument.target.form = 0.0;
    without->noise_ = std::make_shared<const FaceNoise>(FaceNoiseOf(plan_, instrument, run_));
    WhitenRows(*without->noise_, form.columns);
    return {std::move(form.blocks),
            std::make_shared<estimation::ExtendedResidual>(
                without, VectorXd::Zero(form.columns.rows()), std::move(form.columns)),
            without};
  }

 private:
  using MotionJacobian = Eigen::Matrix<double, kProbes, kToolStage>;

  std::vector<machine::ErrorFunction> FunctionsAt(const VectorXd& x) const {
    std::vector<machine::ErrorFunction> functions = functions_;
    Index at = 0;
    for (auto& function : functions) {
      function.SetCoefficients(x.segment(at, function.size()));
      at += function.size();
    }
    return functions;
  }

  // What the probes read by the error motions of all axes; the tilts of the faces.
  MotionJacobian ReadingByMotions(const std::vector<machine::ErrorFunction>& functions,
                                  const VectorXd& shared, Index row,
                                  double* tilts = nullptr) const {
    using Dual = estimation::DualNumber<kToolStage>;
    machine::MotionErrors<Dual> errors;
    for (int axis = 0; axis < machine::kAxes; ++axis) {
      for (int motion = 0; motion < machine::kMotions; ++motion) {
        Dual& error = errors.axes[axis][motion];
        if (axis == plan_.axis) {
          error.a = functions[motion].Evaluate(run_.position[row]);
        }
        error.v[MotionStage(axis, motion)] = 1.0;
      }
    }
    for (Index k = 0; k < 3; ++k) errors.squareness[k] = Dual(shared[k]);
    const auto X_WT = ToolSeenFromWork<Dual>(plan_, run_.AxesAt(row), errors);
    MotionJacobian J;
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      const auto places = Places(probe);
      Eigen::Matrix<Dual, kLocal, 1> local;
      for (std::size_t k = 9; k < kLocal; ++k) {
        local[k] = Dual(shared[places[k]]);
      }
      const auto at = Unpack<Dual>(local);
      J.row(probe) = ReadingOf<Dual>(plan_, probe, X_WT, at).v.transpose();
      if (tilts != nullptr) tilts[probe] = SightOf<Dual>(plan_, probe, X_WT, at).Tilt();
    }
    return J;
  }

  // Where the numbers of Circumstances stand behind the coefficients in x, for one probe.
  std::array<Index, kLocal> Places(std::size_t probe) const {
    std::array<Index, kLocal> places{};
    places.fill(-1);
    for (Index k = 0; k < 3; ++k) places[6 + k] = k;  // squareness
    places[9] = 3 + 2 * probe;
    places[10] = 4 + 2 * probe;
    places[11] = 13 + static_cast<Index>(run_.mounted.channels[probe]);
    for (Index k = 0; k < 12; ++k) places[12 + k] = 18 + k;
    return places;
  }
  static constexpr Index kZero = 30;                 // of the first probe
  static constexpr Index kSlopes = kZero + kProbes;  // of the first motion of X, of gap steps

  void AddSlopes(const std::vector<machine::ErrorFunction>& functions, const VectorXd& shared,
                 VectorXd& values, estimation::RowMatrix* jacobian) const {
    for (Index row = 0; row < run_.rows(); ++row) {
      const MotionJacobian by_motions = ReadingByMotions(functions, shared, row);
      for (Index stage = 0; stage < kToolStage; ++stage) {
        const double step = run_.steps(stage / machine::kMotions, row);
        for (Index probe = 0; probe < by_motions.rows(); ++probe) {
          const double by_slope = by_motions(probe, stage) * step;
          const Index out = probe * run_.rows() + row;
          values[out] -= by_slope * shared[kSlopes + stage];
          if (jacobian != nullptr) (*jacobian)(out, coefficients_ + kSlopes + stage) = -by_slope;
        }
      }
    }
  }

  template <typename T>
  void Rows(const std::vector<machine::ErrorFunction>& functions, const VectorXd& shared, Index row,
            VectorXd& values, estimation::RowMatrix* jacobian) const {
    constexpr bool kDual = !std::is_same_v<T, double>;
    VectorXd gradient(coefficients_);
    Eigen::Matrix<T, kLocal, 1> local;
    Index at = 0;
    for (std::size_t motion = 0; motion < functions.size(); ++motion) {
      local[motion] = T(functions[motion].Evaluate(
          run_.position[row], nullptr, jacobian == nullptr ? nullptr : gradient.data() + at));
      at += functions[motion].size();
    }
    for (Index k = 0; k < 3; ++k) local[6 + k] = T(shared[k]);
    if constexpr (kDual) {
      for (Index k = 0; k < 9; ++k) local[k].v[k] = 1.0;
    }
    for (Index k = 9; k < kLocal; ++k) local[k] = T(0);
    const auto X_WT = ToolSeenFromWork<T>(plan_, run_.AxesAt(row), ErrorsOf<T>(plan_.axis, local));
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      const auto places = Places(probe);
      for (std::size_t k = 9; k < kLocal; ++k) {
        local[k] = T(shared[places[k]]);
        if constexpr (kDual) local[k].v[k] = 1.0;
      }
      const T reading = ReadingOf<T>(plan_, probe, X_WT, Unpack<T>(local));
      const Index out = probe * run_.rows() + row;
      values[out] = run_.gap(probe, row) - ValueOf(reading) - shared[kZero + probe];
      if constexpr (kDual) AddDerivatives(functions, gradient, places, reading.v, out, jacobian);
      if (jacobian != nullptr) (*jacobian)(out, coefficients_ + kZero + probe) = -1.0;
    }
  }

  template <typename Derivatives>
  void AddDerivatives(const std::vector<machine::ErrorFunction>& functions,
                      const VectorXd& gradient, const std::array<Index, kLocal>& places,
                      const Derivatives& by_local, Index out,
                      estimation::RowMatrix* jacobian) const {
    Index at = 0;
    for (std::size_t motion = 0; motion < functions.size(); ++motion) {
      const Index n = functions[motion].size();
      jacobian->row(out).segment(at, n) = -by_local[motion] * gradient.segment(at, n).transpose();
      at += n;
    }
    for (std::size_t k = 6; k < kLocal; ++k) {
      (*jacobian)(out, coefficients_ + places[k]) = -by_local[k];
    }
  }

  SweepPlan plan_;
  SweepRun run_;
  std::vector<machine::ErrorFunction> functions_;
  Index coefficients_ = 0;
  std::shared_ptr<const FaceNoise> noise_;
};

std::shared_ptr<const Response> SweepResidual::At(const VectorXd& x) const {
  const std::vector<machine::ErrorFunction> functions = FunctionsAt(x);
  const VectorXd shared = x.tail(x.size() - coefficients_);
  MatrixXd by_motions(kProbes, kToolStage * run_.rows());
  MatrixXd tilts(kProbes, run_.rows());
  for (Index row = 0; row < run_.rows(); ++row) {
    by_motions.middleCols<kToolStage>(row * kToolStage) =
        ReadingByMotions(functions, shared, row, tilts.col(row).data());
  }
  return std::make_shared<ReadingResponse>(std::move(by_motions), run_.gap, std::move(tilts),
                                           noise_);
}

std::string Named(const std::string& what, const std::string& which) {
  return which.empty() ? what : what + " " + which;
}

// The swept axis does not step: its slopes are held.
ParameterBlock SlopeBlock(const SweepRun& run) {
  ParameterBlock block("step_slope " + run.name, {"um/mm", 1e-3}, {});
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const double tolerance = axis == run.axis - 'X' ? 0.0 : run.slopes(motion, axis);
      block.entries.push_back({.name = machine::MotionName(axis, motion),
                               .prior_sd = tolerance == 0.0 ? estimation::kNoPrior : tolerance,
                               .held = tolerance == 0.0});
    }
  }
  return block;
}

std::vector<ParameterBlock> InstrumentBlocks(const SweepInstrument& instrument,
                                             const SweepRun& run) {
  const probes::HeadTolerance& tolerance = instrument.head.tolerance;
  std::vector<ParameterBlock> blocks;
  ParameterBlock position =
      ParameterBlock::AroundZero("probe_position", estimation::kMicrometres, {}, 0.0);
  ParameterBlock gain = ParameterBlock::AroundZero("probe_gain", kRelative, {}, 0.0);
  ParameterBlock zero =
      ParameterBlock::AroundZero("probe_zero " + run.name, estimation::kMicrometres, {}, 0.0);
  for (std::size_t i = 0; i < kProbes; ++i) {
    const std::string letter = kLetters[i];
    const Eigen::Vector2d place = PlaceOf(instrument.head.layout, i);
    for (int k = 0; k < 2; ++k) {
      const std::string across = OnTop(i) ? "_s" : "_n";
      position.entries.push_back({.name = letter + (k == 0 ? "_u" : across),
                                  .nominal = place[k],
                                  .prior_sd = tolerance.probe_position,
                                  .value = place[k]});
    }
    const double nominal = instrument.head.probes[i].gain;
    gain.entries.push_back(
        {.name = letter, .nominal = nominal, .prior_sd = tolerance.gain, .value = nominal});
    // A start from which the first step is small.
    zero.entries.push_back(
        {.name = letter, .value = run.gap.row(i).mean() - instrument.head.probes[i].range / 2});
  }
  for (ParameterBlock* block : {&position, &gain}) {
    for (auto& entry : block->entries) {
      entry.held = entry.prior_sd == 0.0;
      if (entry.held) entry.prior_sd = estimation::kNoPrior;
    }
  }
  const std::string axis(1, run.axis);
  const std::string& mounting = run.mounting;
  const std::string target = mounting.empty() ? run.name : mounting;
  blocks.push_back(std::move(position));
  blocks.push_back(std::move(gain));
  blocks.push_back(ParameterBlock::AroundZero(Named("head_turn " + axis, target),
                                              estimation::kMicroradians, {"u", "s", "n"},
                                              tolerance.installation));
  blocks.push_back(ParameterBlock::AroundZero(Named("head_place " + axis, target),
                                              estimation::kMicrometres, {"u", "s", "n"},
                                              tolerance.offset));
  blocks.push_back(ParameterBlock::AroundZero(
      Named("target_tilt", target), estimation::kMicroradians, {"a", "b", "c"}, kTargetTilt));
  ParameterBlock squareness =
      ParameterBlock::AroundZero("target_squareness", estimation::kMicroradians, {"YZ", "XZ", "XY"},
                                 instrument.target.u_squareness);
  for (auto& entry : squareness.entries) {
    entry.nominal = entry.value = instrument.target.squareness;
  }
  blocks.push_back(std::move(squareness));
  blocks.push_back(std::move(zero));
  if (run.steps.cols() > 0) blocks.push_back(SlopeBlock(run));
  return blocks;
}

}  // namespace

SimulatedRun SimulateSweep(const machine::VolumetricModel& model, const Vector3d& reference,
                           const SweepInstrument& instrument, const SweepRun& run) {
  SimulatedRun simulated{
      run.name, "sweep", {}, nullptr, estimation::RobustLoss::Huber(kHuberThreshold)};
  SweepRun within = run;
  Eigen::Matrix3Xd axes(3, run.rows());
  axes.colwise() = run.start;  // steps may leave the travel by their few micrometres
  axes.row(run.axis - 'X') = run.position.transpose();
  within.position = AxesInTravel(model, axes, run.name, run.first_rows).row(run.axis - 'X');
  const SweepPlan plan = MakeSweepPlan(model.chain(), reference, instrument.head, run);
  const std::vector<ParameterBlock> machine_blocks = model.Blocks();
  for (int motion = 0; motion < machine::kMotions; ++motion) {
    const std::string name = machine::MotionName(plan.axis, motion);
    for (const ParameterBlock& block : machine_blocks) {
      if (block.name == name) simulated.blocks.push_back(block);
    }
  }
  simulated.blocks.push_back(machine_blocks.back());
  for (ParameterBlock& block : InstrumentBlocks(instrument, run)) {
    simulated.blocks.push_back(std::move(block));
  }
  const auto residual = std::make_shared<SweepResidual>(model, plan, instrument, within);
  simulated.residual = simulated.response = residual;
  simulated.notes = run.notes;
  simulated.heading = Eigen::Matrix3Xd::Zero(3, run.rows());
  simulated.heading.row(run.axis - 'X') = ApproachOf(run.direction);
  FormOfTarget form = FormOfTargetIn(model.chain(), instrument, run);
  if (!form.blocks.empty()) {
    simulated.form_apart = [=] { return residual->Apart(instrument, form); };
    simulated.form_stated = instrument.target.form;
    simulated.form_known_to = instrument.target.form_known_to;
  }
  return simulated;
}

}  // namespace abbe::simulation
