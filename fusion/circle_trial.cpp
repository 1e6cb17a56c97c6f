#include "fusion/circle_trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "estimation/noise_memory.h"
#include "standards/circle_signatures.h"

namespace abbe::fusion {
namespace {

using paths::CirclePoint;
using paths::CircleRun;
using standards::Signature;

constexpr std::size_t kSectors = 36;  // their means show the correlation of neighbouring rows
constexpr double kLargePart = 0.3;    // of a weak direction of length 1

double Rms(const std::vector<Eigen::VectorXd>& residuals) {
  double squares = 0.0, n = 0.0;
  for (const Eigen::VectorXd& one : residuals) {
    squares += one.squaredNorm();
    n += one.size();
  }
  return std::sqrt(squares / n);
}

// Rows less the parameters that the data determine: 1 at least.
double FreedomOf(const CircleFit& fit, double rows) {
  return std::clamp(fit.result.redundancy, 1.0, rows);
}

// The factor by which the means of sectors scatter more than those of independent rows: at least 1.
double Correlated(const std::vector<const CircleRun*>& runs,
                  const std::vector<Eigen::VectorXd>& residuals, double rms) {
  double excess = 0.0, sectors = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    std::array<std::array<double, kSectors>, 2> sums{}, counts{};
    for (std::size_t i = 0; i < runs[r]->points.size(); ++i) {
      const CirclePoint& point = runs[r]->points[i];
      const double part = point.angle / (2 * std::numbers::pi) + 0.5;
      const std::size_t sector =
          std::min(kSectors - 1, static_cast<std::size_t>(std::max(0.0, part) * kSectors));
      const std::size_t sense = point.sense > 0 ? 1 : 0;
      sums[sense][sector] += residuals[r][i];
      counts[sense][sector] += 1.0;
    }
    for (std::size_t sense = 0; sense < 2; ++sense) {
      for (std::size_t k = 0; k < kSectors; ++k) {
        if (counts[sense][k] == 0.0) continue;
        excess += sums[sense][k] * sums[sense][k] / counts[sense][k];
        sectors += 1.0;
      }
    }
  }
  return rms > 0.0 ? std::sqrt(std::max(1.0, excess / sectors / (rms * rms))) : 1.0;
}

double BeyondNoise(const std::vector<Eigen::VectorXd>& residuals, double rms) {
  return rms / std::max(estimation::WhitePart(residuals), kLeastRadialNoise);
}

// The data determine the parameter itself, not only a combination with another.
bool SeenByData(const estimation::Result& result, const std::string& name) {
  if (result.Seen(name) != estimation::SeenBy::kData) return false;
  const auto at = std::ranges::find(result.names, name) - result.names.begin();
  return std::ranges::none_of(result.weak_directions, [&](const estimation::WeakDirection& weak) {
    return std::abs(weak.coefficients[at]) > kLargePart;
  });
}

// The largest coefficient is that of a cause; directions of the nuisance parameters are of no
// interest.
bool IsOfCauses(const estimation::Result& result, const estimation::WeakDirection& weak) {
  Eigen::Index most = 0;
  weak.coefficients.cwiseAbs().maxCoeff(&most);
  return result.names[most].starts_with("cause.");
}

// Where spikes have a form of their own, the size of one is the height of the whole, the same part of
// all runs: the largest of its deviations.
void TakeWholeSpikes(const CircleFit& fit, const CircleEquations& grid,
                     const std::vector<Signature>& table, CircleCauses& found) {
  const auto causes = std::ssize(table);
  const Eigen::Index of_axis = grid.alike.cols() / 2, all = causes + grid.alike.cols();
  Eigen::VectorXd parameters(all);
  parameters << fit.result.Block("cause").Values(), fit.result.Block("alike").Values();
  Eigen::MatrixXd covariance(all, all);
  const Eigen::MatrixXd across = fit.result.Covariance("cause", "alike");
  covariance << fit.result.Covariance("cause", "cause"), across, across.transpose(),
      fit.result.Covariance("alike", "alike");
  Eigen::MatrixXd of_parameters = Eigen::MatrixXd::Identity(causes, all);
  Eigen::Index axis = 0;
  for (Eigen::Index cause = 0; cause < causes; ++cause) {
    if (table[cause].cause != "reversal_spike") continue;
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(grid.causes.rows(), all);
    whole.col(cause) = grid.causes.col(cause);
    const Eigen::Index first = of_axis * axis++;
    whole.middleCols(causes + first, of_axis) = grid.alike.middleCols(first, of_axis);
    const Eigen::VectorXd deviation = whole * parameters;
    Eigen::Index highest = 0;
    deviation.cwiseAbs().maxCoeff(&highest);
    of_parameters.row(cause) = whole.row(highest);
  }
  found.covariance = of_parameters * covariance * of_parameters.transpose();
  const Eigen::VectorXd values = of_parameters * parameters;
  for (Eigen::Index cause = 0; cause < causes; ++cause) {
    found.causes[cause].value = values[cause];
    found.causes[cause].u = std::sqrt(found.covariance(cause, cause));
  }
}

std::vector<CircleEquations> EquationsOf(const std::vector<const CircleRun*>& runs,
                                         const CauseOptions& options, const ReversalForm& form) {
  std::vector<CircleEquations> equations;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    equations.push_back(CentredEquations(runs, run, options, form));
  }
  return equations;
}

}  // namespace

Eigen::Index Rows(const std::vector<const CircleRun*>& runs) {
  Eigen::Index rows = 0;
  for (const CircleRun* run : runs) rows += std::ssize(run->points);
  return rows;
}

CircleTrial FitWith(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
                    const ReversalForm& form, const CircleMemory& memory) {
  const std::vector<Signature> table = CausesOf(*runs.front(), options, form);
  const std::vector<CircleEquations> equations = EquationsOf(runs, options, form);
  CircleCauses found;
  std::vector<Eigen::VectorXd> before;
  before.reserve(equations.size());
  for (const CircleEquations& one : equations) {
    before.emplace_back(one.radial.array() - one.radial.mean());
  }
  found.rms_before = Rms(before);
  const CircleFit first = SolveCircles(equations, table, options, {kLeastRadialNoise, memory});
  const double rows = static_cast<double>(Rows(runs));
  const double rms =
      std::max(Rms(first.white) * std::sqrt(rows / FreedomOf(first, rows)), kLeastRadialNoise);
  found.correlated = Correlated(runs, first.white, rms);
  const CircleFit fit = SolveCircles(equations, table, options, {rms * found.correlated, memory});
  std::vector<Eigen::VectorXd> smooth;
  for (const Eigen::VectorXd& one : fit.smooth) smooth.emplace_back(one.array() - one.mean());
  found.rms_smooth = Rms(smooth);  // a longer ballbar is no error of the machine
  found.rms_after = Rms(fit.noise);
  found.beyond_noise = BeyondNoise(fit.noise, found.rms_after);
  found.covariance = fit.result.Covariance("cause", "cause");
  const double independent = rows / (found.correlated * found.correlated);
  found.freedom = std::max(independent - (rows - FreedomOf(fit, rows)), 1.0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string name = "cause." + CauseName(table[i]);
    CauseEstimate estimate{table[i].cause, table[i].object, table[i].unit, fit.result.Value(name),
                           fit.result.Uncertainty(name)};
    for (const CircleEquations& one : equations) {
      estimate.effect = std::max(
          estimate.effect, std::abs(estimate.value) * one.causes.col(i).cwiseAbs().maxCoeff());
    }
    estimate.seen = SeenByData(fit.result, name);
    estimate.alike = table[i].alike;
    found.causes.push_back(std::move(estimate));
  }
  if (form.spike_size != std::array<double, 2>{}) {
    TakeWholeSpikes(fit, SpikesOnGrid(*runs.front(), options, form), table, found);
  }
  for (const auto& weak : fit.result.weak_directions) {
    if (IsOfCauses(fit.result, weak)) found.weak_directions.push_back(weak.words);
  }
  for (const Eigen::VectorXd& one : fit.unexplained) {
    found.residuals.emplace_back(one.begin(), one.end());
  }
  return {form, std::move(found), fit.longer, fit.wider, fit.improbable, Rms(fit.white)};
}

CircleMemory MemoryBeside(const std::vector<const CircleRun*>& runs, const CauseOptions& options,
                          const CircleTrial& trial) {
  return MemoryOf(EquationsOf(runs, options, trial.form),
                  CausesOf(*runs.front(), options, trial.form), options,
                  std::max(trial.found.rms_after / trial.found.beyond_noise, kLeastRadialNoise));
}

}  // namespace abbe::fusion
