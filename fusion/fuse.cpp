#include "fusion/fuse.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "estimation/linearization.h"
#include "failure/failure.h"
#include "fusion/marginal.h"
#include "fusion/unknown_displacement.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Linearization;
using estimation::Problem;
using estimation::Result;
using simulation::SimulatedRun;

constexpr std::array<double, 6> kLengthsTried{0.5, 0.71, 1.0, 1.41, 2.0, 2.83};  // of the file's
constexpr double kHalf = 0.5;
constexpr Index kTravelStations = 25;  // over a travel, for variances

double LogDeterminant(const Eigen::LDLT<MatrixXd>& factor) {
  return factor.vectorD().cwiseMax(std::numeric_limits<double>::min()).array().log().sum();
}

// The parameters of the machine among all columns of a problem.
std::vector<int> MachineColumns(const estimation::Layout& layout,
                                const machine::VolumetricModel& model) {
  std::vector<int> columns;
  for (const auto& block : model.Blocks()) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto at = std::find(layout.names.begin(), layout.names.end(), block.FullName(i));
      columns.push_back(static_cast<int>(at - layout.names.begin()));
    }
  }
  return columns;
}

map::Source SourceOf(const std::string& kind) {
  const auto found = std::find(map::kSourceNames.begin(), map::kSourceNames.end(), kind);
  return static_cast<map::Source>(found - map::kSourceNames.begin());
}

// A problem with its solution and the information of every source there.
struct Fitted {
  Problem problem;
  Result fit = {};
  Linearization at = {};
};

class FuseJob {
 public:
  FuseJob(const machine::Machine& machine, const std::vector<SimulatedRun>& runs,
          const FuseOptions& options)
      : machine_(machine), runs_(runs), options_(options), model_(UnknownMachine(machine)) {}

  FuseReport Run() {
    double length = machine_.population.smoothness;
    Fitted now = Fit(length, {});
    if (Condense(now.fit)) now = Fit(length, now.fit.blocks);
    std::vector<SmoothnessTried> tried;
    if (options_.choose_smoothness) {
      tried = TryLengths(now);
      const auto best = std::max_element(
          tried.begin(), tried.end(),
          [](const auto& a, const auto& b) { return a.log_evidence < b.log_evidence; });
      if (best->length != length) {
        length = best->length;
        now = Fit(length, now.fit.blocks);
      }
    }
    Describe(now);
    FuseReport report{.map = MapOf(now.fit)};
    report.functions = std::move(functions_);
    report.scale = scale_;
    report.smoothness = std::move(tried);
    report.chosen_smoothness = length;
    report.runs = CheckRuns(now.problem, now.at);
    report.contradicting = Contradicting(report.runs);
    if (options_.holdout > 0) {
      const MachinePrior prior(machine_, model_, length);
      report.held_out = HoldOut(options_.holdout, runs_, [&](const auto& runs) {
        return MakeMachineProblem(machine_, model_, prior, runs);
      });
    }
    report.fit = std::move(now.fit);
    return report;
  }

 private:
  // Starts at the values of `start`, or at the nominal ones where it is empty.
  Fitted Fit(double length, const std::vector<estimation::ParameterBlock>& start) const {
    Fitted fitted{
        MakeMachineProblem(machine_, model_, MachinePrior(machine_, model_, length), runs_)};
    for (const auto& block : start) {
      auto& entries = fitted.problem.Block(fitted.problem.Find(block.name)).entries;
      for (std::size_t i = 0; i < entries.size(); ++i) entries[i].value = block.entries[i].value;
    }
    fitted.fit = simulation::SolveLinkage(fitted.problem, options_.threads, false);
    fitted.at = estimation::Linearize(fitted.problem, estimation::Layout(fitted.problem),
                                      ValuesFound(fitted.fit, fitted.fit.blocks), options_.threads);
    return fitted;
  }

  // Replaces the residuals that need a first fit; false when there are none.
  bool Condense(const Result& fit) {
    bool any = false;
    for (SimulatedRun& run : runs_) {
      if (!run.condense) continue;
      run.residual = run.condense(ValuesFound(fit, run.blocks));
      run.condense = nullptr;
      any = true;
    }
    return any;
  }

  // The precision of the smoothness prior among all columns, and its log determinant.
  std::pair<MatrixXd, double> Smoothness(double length, const std::vector<int>& machine_columns,
                                         Index n) const {
    const MachinePrior prior(machine_, model_, length);
    MatrixXd precision = MatrixXd::Zero(n, n);
    double log_determinant = 0.0;
    std::size_t at = 0;
    for (int axis = 0; axis < machine::kAxes; ++axis) {
      for (int motion = 0; motion < machine::kMotions; ++motion) {
        const MatrixXd W = prior.Whitening(axis, motion);
        const auto size = static_cast<std::size_t>(W.cols());
        const std::vector<int> columns(
            machine_columns.begin() + static_cast<std::ptrdiff_t>(at),
            machine_columns.begin() + static_cast<std::ptrdiff_t>(at + size));
        const MatrixXd P = W.transpose() * W;
        precision(columns, columns) += P;
        // W = diag(1/sd) V': det P is the product of 1/sd^2, and the rows of W have the length
        // 1/sd.
        log_determinant += 2.0 * W.rowwise().norm().array().log().sum();
        at += size;
      }
    }
    return {precision, log_determinant};
  }

  std::vector<SmoothnessTried> TryLengths(const Fitted& fitted) const {
    const estimation::Layout layout(fitted.problem);
    const VectorXd x = ValuesFound(fitted.fit, fitted.fit.blocks);
    const Linearization& at = fitted.at;
    const std::vector<int> columns = MachineColumns(layout, model_);
    // Information and gradient at x without the smoothness prior; its own part comes from x below.
    MatrixXd information = at.prior.information;
    VectorXd gradient = at.prior.gradient;
    for (std::size_t s = 0; s < runs_.size(); ++s) {
      information += at.sources[s].information;
      gradient += at.sources[s].gradient;
    }
    VectorXd now(layout.columns());
    for (Index c = 0; c < now.size(); ++c) {
      now[c] = x[layout.entry_of_column[static_cast<std::size_t>(c)]];
    }
    VectorXd coefficients = VectorXd::Zero(now.size());
    for (std::size_t i = 0; i + 3 < columns.size(); ++i) coefficients[columns[i]] = now[columns[i]];
    std::vector<SmoothnessTried> tried;
    double base = 0.0;
    for (const double factor : kLengthsTried) {
      const double length = factor * machine_.population.smoothness;
      const auto [precision, log_determinant] = Smoothness(length, columns, now.size());
      const MatrixXd H = information + precision;
      const VectorXd g = gradient + precision * coefficients;
      const Eigen::LDLT<MatrixXd> factorized(H);
      const double chi_square =
          coefficients.dot(precision * coefficients) - g.dot(factorized.solve(g));
      const double evidence = 0.5 * (log_determinant - LogDeterminant(factorized) - chi_square);
      if (factor == 1.0) base = evidence;
      tried.push_back({length, evidence});
    }
    for (auto& each : tried) each.log_evidence -= base;
    return tried;
  }

  // The rows that give the values of one error over the travel; of a squareness itself.
  MatrixXd ValuesOf(int error) const {
    const Index n = model_.ParameterCount();
    if (error >= machine::kAxes * machine::kMotions) {
      return Eigen::RowVectorXd::Unit(n, n - 3 + error - machine::kAxes * machine::kMotions);
    }
    const int axis = error / machine::kMotions, motion = error % machine::kMotions;
    Index first = 0;
    for (int e = 0; e < error; ++e) {
      first += model_.Function(e / machine::kMotions, e % machine::kMotions).size();
    }
    const auto& function = model_.Function(axis, motion);
    const auto& travel = machine_.travels[static_cast<std::size_t>(axis)];
    const VectorXd stations = VectorXd::LinSpaced(kTravelStations, travel.first, travel.last);
    MatrixXd rows = MatrixXd::Zero(kTravelStations, n);
    VectorXd gradient(function.size());
    for (Index i = 0; i < kTravelStations; ++i) {
      function.Evaluate(stations[i], nullptr, gradient.data());
      rows.row(i).segment(first, function.size()) = gradient.transpose();
    }
    return rows;
  }

  // The mean slope of EXX, EYY and EZZ over the axes of the machine.
  Eigen::RowVectorXd ScaleRow() const {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(model_.ParameterCount());
    int axes = 0;
    for (int axis = 0; axis < machine::kAxes; ++axis) {
      const auto& travel = machine_.travels[static_cast<std::size_t>(axis)];
      if (!(travel.last > travel.first)) continue;
      const VectorXd x = VectorXd::LinSpaced(kTravelStations, travel.first, travel.last);
      const VectorXd centred = x.array() - x.mean();
      row +=
          centred.transpose() * ValuesOf(machine::kMotions * axis + axis) / centred.squaredNorm();
      ++axes;
    }
    return row / axes;
  }

  void Describe(const Fitted& now) {
    const Linearization& at = now.at;
    const std::vector<int> columns = MachineColumns(estimation::Layout(now.problem), model_);
    MatrixXd prior = at.prior.information + at.sources.back().information;
    MatrixXd all = prior;
    std::map<std::string, MatrixXd> kinds;
    for (std::size_t s = 0; s < runs_.size(); ++s) {
      auto& kind = kinds.try_emplace(runs_[s].kind, prior).first->second;
      kind += at.sources[s].information;
      all += at.sources[s].information;
    }
    const auto of_machine = [&](const MatrixXd& information) {
      return MarginalCovariance(information, columns);
    };
    const MatrixXd C_prior = of_machine(prior);
    cov_pp_ = of_machine(all);
    AddDoubt(now.fit);
    std::map<std::string, MatrixXd> C_kinds;
    for (const auto& [kind, information] : kinds) C_kinds[kind] = of_machine(information);
    const auto variance = [](const MatrixXd& E, const MatrixXd& C) {
      return (E * C).cwiseProduct(E).sum() / static_cast<double>(E.rows());
    };
    for (int error = 0; error < map::kErrors; ++error) {
      const MatrixXd E = ValuesOf(error);
      const double before = variance(E, C_prior);
      FunctionSeen seen{
          map::ErrorName(error), std::sqrt(before), std::sqrt(variance(E, cov_pp_)), {}};
      std::vector<std::pair<double, std::string>> by;
      for (const auto& [kind, C] : C_kinds) {
        const double after = variance(E, C);
        if (after < kHalf * before) by.emplace_back(after, kind);
      }
      std::sort(by.begin(), by.end());
      for (auto& [after, kind] : by) seen.determined_by.push_back(kind);
      functions_.push_back(std::move(seen));
    }
    const Eigen::RowVectorXd row = ScaleRow();
    scale_.prior = std::sqrt(variance(row, C_prior));
    scale_.u = std::sqrt(variance(row, cov_pp_));
    scale_.calibrated = scale_.u * scale_.u < kHalf * scale_.prior * scale_.prior;
  }

  void AddDoubt(const Result& fit) {
    const Doubt& doubt = options_.doubt;
    if (doubt.other != nullptr) {
      const VectorXd other = doubt.other->model().Parameters();
      if (other.size() != cov_pp_.rows()) {
        throw InputError("maps of different functions cannot be held against each other");
      }
      const VectorXd change = ValuesFound(fit, model_.Blocks()) - other;
      cov_pp_ += change * change.transpose();
    }
    if (doubt.displacement > 0.0) {
      cov_pp_ += UnknownDisplacement(model_, -machine_.reference, doubt.displacement);
    }
  }

  map::ErrorMap MapOf(const Result& fit) {
    machine::VolumetricModel model = model_;
    const VectorXd values = ValuesFound(fit, model.Blocks());
    model.SetParameters(values);
    scale_.value = ScaleRow().dot(values);
    map::MapOrigin origin;
    origin.machine = machine_.name;
    origin.reference = machine_.reference;
    origin.tool = -machine_.reference;
    origin.scale_is_calibrated = scale_.calibrated;
    origin.limits = machine_.limits;
    for (std::size_t error = 0; error < functions_.size(); ++error) {
      const auto& by = functions_[error].determined_by;
      if (!by.empty()) origin.sources[error] = SourceOf(by.front());
    }
    return {origin, model, cov_pp_};
  }

  const machine::Machine& machine_;
  std::vector<SimulatedRun> runs_;
  const FuseOptions options_;
  const machine::VolumetricModel model_;
  MatrixXd cov_pp_;
  std::vector<FunctionSeen> functions_;
  ScaleSeen scale_;
};

}  // namespace

FuseReport Fuse(const machine::Machine& machine, const std::vector<SimulatedRun>& runs,
                const FuseOptions& options) {
  return FuseJob(machine, runs, options).Run();
}

}  // namespace abbe::fusion
