#include "fusion/pose_choice.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Factor = Eigen::LLT<MatrixXd>;

constexpr int kMostSweeps = 20;
constexpr double kGain = 1e-9;     // of the log determinant
constexpr double kEnough = 0.458;  // sqrt(1.1^2 - 1): calibration over noise of a reading

void Add(const PoseInformation& candidates, Index pose, MatrixXd& information) {
  const auto J = candidates.white.middleRows<3>(3 * pose);
  information.noalias() += J.transpose() * J;
}

// P^-1 + sum J' J, in units of the priors.
MatrixXd Information(const PoseInformation& candidates, const std::vector<Index>& poses) {
  MatrixXd information = MatrixXd::Identity(candidates.white.cols(), candidates.white.cols());
  for (const Index pose : poses) Add(candidates, pose, information);
  return information;
}

double LogDeterminant(const Factor& factor) {
  return 2.0 * MatrixXd(factor.matrixL()).diagonal().array().log().sum();
}

// The best pose that is not chosen yet, and the increase of the log determinant by it.
std::pair<Index, double> Best(const PoseInformation& candidates, const Factor& factor,
                              const std::vector<bool>& chosen) {
  // J C J' = W' W with W = L^-1 J': as a square it stays positive however weak the prior.
  const MatrixXd W = factor.matrixL().solve(candidates.white.transpose());
  std::pair<Index, double> best{-1, -1.0};
  for (Index pose = 0; pose < candidates.poses(); ++pose) {
    if (chosen[pose]) continue;
    const auto w = W.middleCols<3>(3 * pose);
    const Matrix3d m = Matrix3d::Identity() + w.transpose() * w;
    const double gain = std::log(m.determinant());
    if (gain > best.second) best = {pose, gain};
  }
  return best;
}

std::vector<Index> Without(std::vector<Index> poses, Index pose) {
  std::erase(poses, pose);
  return poses;
}

double TipRms(const PoseInformation& candidates, const Factor& factor) {
  const MatrixXd W = factor.matrixL().solve(candidates.tip.transpose());
  return std::sqrt(W.squaredNorm() / candidates.poses());
}

}  // namespace

PoseInformation::PoseInformation(const simulation::LinkageSimulation& simulation,
                                 const simulation::LinkageRun& run, const VectorXd& x) {
  Matrix3Xd gap;
  estimation::RowMatrix J;
  simulation.Gap(run, x, gap, &J);
  std::vector<Index> free;
  std::vector<double> scale;
  Index at = 0;
  for (const auto& block : simulation.Blocks()) {
    for (const auto& entry : block.entries) {
      if (!entry.held) {
        free.push_back(at);
        scale.push_back(std::isfinite(entry.prior_sd) ? entry.prior_sd : 1.0);
      }
      ++at;
    }
  }
  const Index columns = scale.size();
  tip = J(Eigen::all, free) * Eigen::Map<const VectorXd>(scale.data(), columns).asDiagonal();
  white = tip;
  const Matrix3Xd noise = simulation.GapNoise(run);
  double variance = 0.0;
  for (Index pose = 0; pose < run.poses(); ++pose) {
    const Matrix3d factor = noise.middleCols<3>(3 * pose);
    factor.triangularView<Eigen::Lower>().solveInPlace(white.middleRows<3>(3 * pose));
    variance += factor.squaredNorm() - run.reference_sd.col(pose).squaredNorm();
  }
  reading_noise = std::sqrt(std::max(0.0, variance / run.poses()));
}

double TipUncertainty(const PoseInformation& candidates, const std::vector<Index>& poses) {
  return TipRms(candidates, Factor(Information(candidates, poses)));
}

PoseChoice ChoosePoses(const PoseInformation& candidates, Index count) {
  if (count < 1 || count > candidates.poses()) {
    throw InputError(fmt::format("{} poses cannot be chosen from {} candidates; ask for 1 to {}",
                                 count, candidates.poses(), candidates.poses()));
  }
  PoseChoice choice{};
  std::vector<bool> chosen(candidates.poses(), false);
  const auto mark = [&](Index pose, bool in) { chosen[pose] = in; };
  MatrixXd information = Information(candidates, {});
  for (Index i = 0; i < count; ++i) {
    const Index pose = Best(candidates, Factor(information), chosen).first;
    Add(candidates, pose, information);
    choice.poses.push_back(pose);
    mark(pose, true);
  }
  choice.log_determinant = LogDeterminant(Factor(information));
  bool exchanged = count < candidates.poses();
  for (int sweep = 0; exchanged && sweep < kMostSweeps; ++sweep) {
    exchanged = false;
    for (Index& pose : choice.poses) {
      const auto others = Without(choice.poses, pose);
      const Factor without(Information(candidates, others));
      const auto [other, gain] = Best(candidates, without, chosen);
      const double reached = LogDeterminant(without) + gain;
      if (reached < choice.log_determinant + kGain) continue;
      mark(pose, false);
      mark(other, true);
      pose = other;
      choice.log_determinant = reached;
      ++choice.exchanges;
      exchanged = true;
    }
  }
  choice.tip_rms = TipUncertainty(candidates, choice.poses);
  return choice;
}

std::vector<EnoughRow> HowManyPoses(const PoseInformation& candidates,
                                    const std::vector<Index>& counts) {
  std::vector<EnoughRow> rows;
  for (const Index count : counts) {
    if (count > candidates.poses()) continue;
    const PoseChoice choice = ChoosePoses(candidates, count);
    std::vector<Index> even;
    for (Index i = 0; i < count; ++i)
      even.push_back((2 * i + 1) * candidates.poses() / (2 * count));
    rows.push_back({count, choice.tip_rms, TipUncertainty(candidates, even),
                    choice.tip_rms < kEnough * candidates.reading_noise});
  }
  return rows;
}

}  // namespace abbe::fusion
