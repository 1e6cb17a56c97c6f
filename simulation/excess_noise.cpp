#include "simulation/excess_noise.h"

#include <cmath>

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The residual without its level and the drift of the time constant that explains most, whatever
// their sizes.
VectorXd WithoutDrift(const VectorXd& left) {
  constexpr double kFirst = 5.0, kStep = 1.5;  // poses
  const Index poses = left.size() / 3;
  const auto rows = left.reshaped(3, poses);
  const VectorXd order = VectorXd::LinSpaced(poses, 0.0, static_cast<double>(poses - 1));
  double most = 0.0;
  const Eigen::Vector3d level = rows.rowwise().mean();
  VectorXd drift = VectorXd::Zero(left.size());
  for (double tau = kFirst; tau < 4.0 * static_cast<double>(poses); tau *= kStep) {
    VectorXd fading = (-order / tau).array().exp();
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
  const double least = kByChance / std::sqrt(static_cast<double>(left.size()));
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

double ExcessOf(const estimation::SourceResult& run, const VectorXd& left, double used) {
  constexpr double kFewest = 6.0, kOfDrift = 4.0;  // degrees of freedom: that tell a noise
  const double redundancy = run.redundancy - kOfDrift;
  if (redundancy < kFewest) return used;
  const VectorXd still = WithoutDrift(left);
  const double chi_square = run.chi_square * still.squaredNorm() / left.squaredNorm();
  const double excess = used * std::sqrt(chi_square / redundancy);
  return excess > kNoiseIsKnown ? excess * std::sqrt(SharedBy(still)) : 1.0;
}

}  // namespace abbe::simulation
