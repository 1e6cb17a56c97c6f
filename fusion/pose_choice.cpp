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

constexpr int kMostSweeps = 20;
constexpr double kGain = 1e-9;     // of the log determinant
constexpr double kEnough = 0.458;  // sqrt(1.1^2 - 1): calibration over noise of a reading

MatrixXd Covariance(const PoseInformation& candidates, const std::vector<Index>& poses) {
  const Index n = candidates.white.cols();
  MatrixXd information = MatrixXd::Identity(n, n);
  for (const Index pose : poses) {
    const auto J = candidates.white.middleRows<3>(3 * pose);
    information.noalias() += J.transpose() * J;
  }
  return information.llt().solve(MatrixXd::Identity(n, n));
}

// What the logarithm of the determinant gains by a pose, or loses without it (sign -1).
double Gain(const MatrixXd& J, const MatrixXd& covariance, double sign) {
  const Matrix3d m = Matrix3d::Identity() + sign * J * covariance * J.transpose();
  return std::log(m.determinant());
}

void Update(const MatrixXd& J, double sign, MatrixXd& covariance) {
  const MatrixXd JC = J * covariance;
  const Matrix3d m = Matrix3d::Identity() + sign * JC * J.transpose();
  covariance -= sign * JC.transpose() * m.inverse() * JC;
}

// The best pose that is not chosen yet, and its gain.
std::pair<Index, double> Best(const PoseInformation& candidates, const MatrixXd& covariance,
                              const std::vector<bool>& chosen) {
  // All J C J' at once: the rows of J C, times the same rows of J.
  const MatrixXd JC = candidates.white * covariance;
  std::pair<Index, double> best{-1, -1.0};
  for (Index pose = 0; pose < candidates.poses(); ++pose) {
    if (chosen[static_cast<std::size_t>(pose)]) continue;
    const Matrix3d m =
        Matrix3d::Identity() +
        JC.middleRows<3>(3 * pose) * candidates.white.middleRows<3>(3 * pose).transpose();
    const double gain = std::log(m.determinant());
    if (gain > best.second) best = {pose, gain};
  }
  return best;
}

double TipRms(const PoseInformation& candidates, const MatrixXd& covariance) {
  const MatrixXd JC = candidates.tip * covariance;
  return std::sqrt(JC.cwiseProduct(candidates.tip).sum() / static_cast<double>(candidates.poses()));
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
  const auto columns = static_cast<Index>(scale.size());
  tip = J(Eigen::all, free) * Eigen::Map<const VectorXd>(scale.data(), columns).asDiagonal();
  white = tip;
  const Matrix3Xd noise = simulation.GapNoise(run);
  double variance = 0.0;
  for (Index pose = 0; pose < run.poses(); ++pose) {
    const Matrix3d factor = noise.middleCols<3>(3 * pose);
    factor.triangularView<Eigen::Lower>().solveInPlace(white.middleRows<3>(3 * pose));
    variance += factor.squaredNorm() - run.reference_sd.col(pose).squaredNorm();
  }
  reading_noise = std::sqrt(std::max(0.0, variance / static_cast<double>(run.poses())));
}

double TipUncertainty(const PoseInformation& candidates, const std::vector<Index>& poses) {
  return TipRms(candidates, Covariance(candidates, poses));
}

PoseChoice ChoosePoses(const PoseInformation& candidates, Index count) {
  if (count < 1 || count > candidates.poses()) {
    throw InputError(fmt::format("{} poses cannot be chosen from {} candidates; ask for 1 to {}",
                                 count, candidates.poses(), candidates.poses()));
  }
  PoseChoice choice{};
  const auto J = [&](Index pose) { return candidates.white.middleRows<3>(3 * pose); };
  std::vector<bool> chosen(static_cast<std::size_t>(candidates.poses()), false);
  const auto mark = [&](Index pose, bool in) { chosen[static_cast<std::size_t>(pose)] = in; };
  MatrixXd covariance = Covariance(candidates, {});
  for (Index i = 0; i < count; ++i) {
    const auto [pose, gain] = Best(candidates, covariance, chosen);
    Update(J(pose), 1.0, covariance);
    choice.poses.push_back(pose);
    choice.log_determinant += gain;
    mark(pose, true);
  }
  bool exchanged = count < candidates.poses();
  for (int sweep = 0; exchanged && sweep < kMostSweeps; ++sweep) {
    exchanged = false;
    for (Index& pose : choice.poses) {
      const double loss = Gain(J(pose), covariance, -1.0);
      MatrixXd without = covariance;
      Update(J(pose), -1.0, without);
      const auto [other, gain] = Best(candidates, without, chosen);
      if (loss + gain < kGain) continue;
      Update(J(other), 1.0, without);
      covariance = without;
      mark(pose, false);
      mark(other, true);
      pose = other;
      choice.log_determinant += loss + gain;
      ++choice.exchanges;
      exchanged = true;
    }
    covariance = Covariance(candidates, choice.poses);  // free of what the updates have lost
  }
  choice.tip_rms = TipRms(candidates, covariance);
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
