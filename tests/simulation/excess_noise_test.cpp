#include "simulation/excess_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "random/counter_random.h"

namespace abbe::simulation {
namespace excess_noise_test {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kPoses = 1000;

// White noise of `size` times the stated one, and a drift along one direction.
VectorXd Left(double size, double drift, double tau) {
  const random::CounterRandom random(5, 3);
  VectorXd left(3 * kPoses);
  for (Index i = 0; i < left.size(); ++i) {
    left[i] = size * random.Normal(static_cast<std::uint64_t>(i));
  }
  const Vector3d along = drift * Vector3d(0.7, 0.1, -0.7);
  for (Index pose = 0; pose < kPoses; ++pose) {
    left.segment<3>(3 * pose) += along * std::exp(-static_cast<double>(pose) / tau);
  }
  return left;
}

const VectorXd kInOrder = VectorXd::LinSpaced(kPoses, 0.0, 2.0 * kPoses);  // s

double ExcessIn(const VectorXd& left, const VectorXd& time = kInOrder) {
  estimation::SourceResult run;
  run.chi_square = left.squaredNorm();
  run.redundancy = static_cast<double>(left.size());
  return ExcessOf(run, left, time, 1.0);
}

// The deviation of 3000 numbers is known to 1.3 %; twice that, and some correlations by chance.
constexpr double kByChance = 0.1;

TEST(ExcessNoise, OfWhiteNoiseIsItsSize) {
  EXPECT_EQ(ExcessIn(Left(1.0, 0.0, 1.0)), 1.0);
  EXPECT_NEAR(ExcessIn(Left(8.0, 0.0, 1.0)), 8.0, 8.0 * kByChance);
}

TEST(ExcessNoise, DoesNotCountADrift) {
  for (const double tau : {30.0, 170.0, 2000.0}) {
    EXPECT_NEAR(ExcessIn(Left(8.0, 20.0, tau)), ExcessIn(Left(8.0, 0.0, tau)), 8.0 * kByChance)
        << tau;
  }
}

TEST(ExcessNoise, CountsWhatNeighboursShareAsOftenAsTheyDo) {
  VectorXd left = Left(8.0, 0.0, 1.0);
  constexpr Index kTogether = 10;
  for (Index pose = 0; pose < kPoses; ++pose) {
    left.segment<3>(3 * pose) = left.segment<3>(3 * (pose - pose % kTogether)).eval();
  }
  // The mean of such a run scatters like that of a tenth of the poses.
  EXPECT_NEAR(ExcessIn(left) / (8.0 * std::sqrt(10.0)), 1.0, 0.3);
}

// Nothing of a run whose order is not known says which poses are neighbours.
TEST(ExcessNoise, CountsADriftWithoutAnOrderAsNoise) {
  const VectorXd unknown = VectorXd::Zero(kPoses), drifting = Left(8.0, 20.0, 300.0);
  EXPECT_DOUBLE_EQ(ExcessIn(drifting, unknown),
                   drifting.norm() / std::sqrt(static_cast<double>(drifting.size())));
}

}  // namespace excess_noise_test
}  // namespace abbe::simulation
