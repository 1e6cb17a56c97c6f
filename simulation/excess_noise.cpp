#include "simulation/excess_noise.h"

#include <algorithm>
#include <cmath>

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The residual without its level and the drift of the time constant that explains most, whatever
// their sizes.
VectorXd WithoutDrift(const VectorXd& left, const VectorXd& time) {
  constexpr double kFirst = 5.0, kStep = 1.5;  // poses, at an even pace
  const Index poses = left.size() / 3;
  const auto rows = left.reshaped(3, poses);
  const double span = time[poses - 1] - time[0];
  const double first = kFirst * span / (poses - 1);
  double most = 0.0;
  const Eigen::Vector3d level = rows.rowwise().mean();
  VectorXd drift = VectorXd::Zero(left.size());
  for (double tau = first; tau < 4.0 * span; tau *= kStep) {
    VectorXd fading = ((time[0] - time.array()) / tau).exp();
    fading.array() -= fading.mean();
    const Eigen::Vector3d amplitude = rows * fading / fading.squaredNorm();
    const double gain = amplitude.squaredNorm() * fading.squaredNorm();
    if (gain <= most) continue;
    most = gain;
    drift = (amplitude * fading.transpose()).reshaped();
  }
  return left - drift - level.replicate(poses, 1);
}

// Poses that share what is left, 1 of white noise.
double SharedBy(const VectorXd& left) {
  constexpr double kByChance = 2.0;  // standard deviations of the correlation of white noise
  const Index poses = left.size() / 3;
  const auto rows = left.reshaped(3, poses);
  const double least = kByChance / std::sqrt(left.size());
  double shared = 1.0;
  for (Index lag = 1; lag < poses / 2; ++lag) {
    const double rho = rows.leftCols(poses - lag).cwiseProduct(rows.rightCols(poses - lag)).sum() /
                       left.squaredNorm();
    if (rho < least) break;
    shared += 2.0 * rho;
  }
  return shared;
}

}  // namespace

double ExcessOf(const estimation::SourceResult& run, const VectorXd& left, const VectorXd& time,
                double used) {
  constexpr double kFewest = 6.0;  // degrees of freedom: that tell a noise
  const bool in_order = time[time.size() - 1] > time[0];
  const double of_drift = in_order ? 4.0 : 0.0;
  const double redundancy = run.redundancy - of_drift;
  if (redundancy < kFewest) return used;
  const VectorXd still = in_order ? WithoutDrift(left, time) : left;
  const double chi_square = run.chi_square * still.squaredNorm() / left.squaredNorm();
  const double excess = used * std::sqrt(chi_square / redundancy);
  if (!(excess > kNoiseIsKnown)) return 1.0;
  return in_order ? excess * std::sqrt(SharedBy(still)) : excess;
}

double SharedLeft(const Eigen::MatrixXd& angles, const VectorXd& left,
                  const Eigen::MatrixXd& other_angles, const VectorXd& other_left) {
  constexpr double kSameAngle = 1e-4;  // rad
  constexpr double kByChance = 2.0;    // standard deviations
  double product = 0.0;
  for (Index i = 0; i < angles.cols(); ++i) {
    for (Index j = 0; j < other_angles.cols(); ++j) {
      const double apart = (angles.col(i) - other_angles.col(j)).cwiseAbs().maxCoeff();
      if (!(apart < kSameAngle)) continue;
      product += left.segment<3>(3 * i).dot(other_left.segment<3>(3 * j));
      break;
    }
  }
  const double shared = product / (left.norm() * other_left.norm());
  const double rows = std::min(left.size(), other_left.size());
  return shared * std::sqrt(rows) < kByChance ? 0.0 : shared;
}

}  // namespace abbe::simulation
