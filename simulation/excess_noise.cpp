#include "simulation/excess_noise.h"

#include <cmath>

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

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
  constexpr double kFewest = 6.0;  // degrees of freedom that tell a noise
  if (run.redundancy < kFewest) return used;
  const double excess = used * std::sqrt(run.chi_square / run.redundancy);
  return excess > kNoiseIsKnown ? excess * std::sqrt(SharedBy(left)) : 1.0;
}

}  // namespace abbe::simulation
