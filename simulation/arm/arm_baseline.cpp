#include "simulation/arm/arm_baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "failure/failure.h"
#include "simulation/arm/arm_run.h"
#include "simulation/excess_noise.h"
#include "simulation/linkage/linkage_gaps.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kRounds = 2;             // of leaving out: the worst hide others, once
constexpr double kSettled = 0.02;      // standard uncertainties, as Fit
constexpr double kFar = 8.0;           // times the usual gap, as invalid readings
constexpr double kMedianNorm = 1.538;  // of three normal numbers of deviation 1
constexpr Index kShareOut = 10;        // one in so many at most

// An arm as it was fitted.
struct Fitted {
  const relm::LinkageSettings& settings;
  const VectorXd& x;
};

VectorXd WhiteGaps(const LinkageRun& run, const Fitted& fitted) {
  const LinkageGaps gaps(ArmSimulation(fitted.settings), run);
  VectorXd rows(gaps.Rows());
  gaps.Evaluate(fitted.x, rows, nullptr);
  return rows;
}

// The whitened gaps of all poses against the lenient arm.
VectorXd NormsOf(const LinkageRun& run, const ArmBaseline& baseline) {
  const VectorXd gaps = WhiteGaps(run, {baseline.lenient, baseline.lenient_x});
  return gaps.reshaped(3, run.poses()).colwise().norm().transpose();
}

estimation::Result FitOf(const LinkageRun& run, const relm::LinkageSettings& settings,
                         const Eigen::Vector3d& ball) {
  const LinkageSimulation arm = ArmSimulation(settings);
  return SolveLinkage(ArmProblem({SimulateArm(arm, run, StartAt(arm, ball), 1.0)}), 1, false,
                      kSettled);
}

std::vector<Index> Within(const VectorXd& norms, double far) {
  std::vector<Index> kept;
  for (Index pose = 0; pose < norms.size(); ++pose) {
    if (norms[pose] <= far) kept.push_back(pose);
  }
  return kept;
}

double FarFrom(const VectorXd& norms, const std::vector<Index>& kept) {
  VectorXd usual = norms(kept);
  const auto middle = usual.begin() + usual.size() / 2;
  std::nth_element(usual.begin(), middle, usual.end());
  const double far = kFar * std::max(1.0, *middle / kMedianNorm);
  const bool few = std::ssize(Within(norms, far)) >= norms.size() - norms.size() / kShareOut;
  return few ? far : std::numeric_limits<double>::infinity();
}

void RefuseOtherArm(const LinkageRun& run, const ArmBaseline& baseline) {
  constexpr double kShare = 0.05;     // of the way
  constexpr double kLeastGap = 5e-3;  // m: what no tolerance explains
  const double count = std::sqrt(run.poses());
  const double gap = GapsOf(run, baseline).norm() / count;
  const double way =
      (run.reference.colwise() - run.reference.rowwise().mean().eval()).norm() / count;
  if (gap < kLeastGap || gap < kShare * way) return;
  throw InputError(fmt::format(
      "{}: the arm of the machine file does not go where the instrument saw it, {:.1f} mm rms "
      "apart over {:.1f} mm rms of way; [linkage] is not that of the recording, or its pivots "
      "stand in "
      "another order or sense",
      run.name, 1e3 * gap, 1e3 * way));
}

ArmBaseline Fitting(const LinkageRun& run, ArmBaseline baseline) {
  auto& tolerance = baseline.lenient.tolerance;
  tolerance.eccentricity = std::max(kLenient, tolerance.eccentricity);
  tolerance.weight = std::max(kLenient, tolerance.weight);
  tolerance.graduation = std::max(kLenient, tolerance.graduation);
  baseline.lenient.graduation_harmonics = {2, 3};
  const Eigen::Vector3d ball = BallSeen(baseline.settings, run);
  std::vector<Index> kept = Within(VectorXd::Zero(run.poses()), 0.0);
  for (int round = 0; round < kRounds; ++round) {
    const estimation::Result fit = FitOf(Selection(run, kept), baseline.lenient, ball);
    baseline.lenient_x = ParametersOf(fit.blocks, run.mounting);
    const VectorXd norms = NormsOf(run, baseline);
    baseline.far = FarFrom(norms, kept);
    std::vector<Index> next = Within(norms, baseline.far);
    if (next == kept) break;
    kept = std::move(next);
  }
  const LinkageRun rest = Selection(run, kept);
  const estimation::Result fit = FitOf(rest, baseline.settings, ball);
  baseline.x = ParametersOf(fit.blocks, run.mounting);
  baseline.excess = ExcessOf(fit.sources.front(), WhiteGaps(rest, {baseline.settings, baseline.x}),
                             rest.time, 1.0);
  return baseline;
}

}  // namespace

ArmBaseline FitArm(const LinkageRun& run, const relm::LinkageSettings& placed) {
  const LinkageSimulation arm = ArmSimulation(placed);
  ArmBaseline nominal{run.mounting, run.ball, placed, StartAt(arm, BallSeen(placed, run)),
                      placed,       {}};
  try {
    ArmBaseline fitted = Fitting(run, nominal);
    RefuseOtherArm(run, fitted);
    return fitted;
  } catch (const NumericalError&) {
    RefuseOtherArm(run, nominal);
    throw;
  }
}

std::vector<Index> FarOff(const LinkageRun& run, const ArmBaseline& baseline) {
  const VectorXd norms = NormsOf(run, baseline);
  std::vector<Index> far;
  for (Index pose = 0; pose < norms.size(); ++pose) {
    if (norms[pose] > baseline.far) far.push_back(pose);
  }
  return far;
}

Eigen::Matrix3Xd GapsOf(const LinkageRun& run, const ArmBaseline& baseline) {
  Eigen::Matrix3Xd gaps;
  ArmSimulation(baseline.settings).Gap(run, baseline.x, gaps);
  return gaps;
}

}  // namespace abbe::simulation
