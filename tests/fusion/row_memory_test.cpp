// What goes on from row to row: against dense covariances, and draws of a known memory.
#include "fusion/row_memory.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>

#include "random/counter_random.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kInstants = 120, kChannels = 2, kRows = kInstants * kChannels;

MatrixXd CovarianceOf(const VectorXd& times, const estimation::NoiseMemory& noise) {
  MatrixXd V = MatrixXd::Zero(kRows, kRows);
  for (Index i = 0; i < kRows; ++i) {
    for (Index j = 0; j < kRows; ++j) {
      if (i % kChannels != j % kChannels) continue;
      const double apart = std::abs(times[i / kChannels] - times[j / kChannels]);
      V(i, j) = noise.slow * noise.slow * std::exp(-apart / noise.time);
      if (i == j) V(i, j) += noise.white * noise.white;
    }
  }
  return V;
}

// Rows that a few sines over the instants and an unknown offset of each channel may explain.
struct World {
  VectorXd times = VectorXd::LinSpaced(kInstants, 0.0, 600.0);
  MatrixXd J = MatrixXd::Zero(kRows, 6);
  MatrixXd H = MatrixXd::Identity(6, 6);
  VectorXd g = VectorXd::Zero(6), left;

  World(unsigned seed, const estimation::NoiseMemory& noise) {
    const random::CounterRandom draw(seed, 1);
    std::uint64_t next = 0;
    const auto normals = [&](Index size) {
      return VectorXd(VectorXd::NullaryExpr(size, [&] { return draw.Normal(next++); }));
    };
    for (Index i = 0; i < kRows; ++i) {
      const double phase = 0.7 * static_cast<double>(i / kChannels);
      J.row(i) << (i % kChannels == 0 ? 1.0 : 0.0), (i % kChannels == 1 ? 1.0 : 0.0),
          std::sin(phase), std::cos(phase), std::sin(2.1 * phase), std::cos(2.1 * phase);
    }
    H.diagonal().head<2>().setZero();  // the offsets have no prior
    const VectorXd x = 3.0 * normals(6);
    g.tail<4>() = -normals(4);
    left = -J * x + MatrixXd(CovarianceOf(times, noise).llt().matrixL()) * normals(kRows);
  }

  RowMemory Found() const { return FindRowMemory({times, J, left, H, g}); }

  // The logarithm of the density, but for a constant, by the dense covariance.
  double LogOf(const estimation::NoiseMemory& noise) const {
    MatrixXd known = H;
    known.diagonal().head<2>().array() += 1e-9 * kInstants;
    const MatrixXd C = known.inverse();
    const Eigen::LLT<MatrixXd> V(MatrixXd(J * C * J.transpose() + CovarianceOf(times, noise)));
    const VectorXd off = left - J * C * g;
    const double of_stated = 20.0 * (2.0 * std::log(noise.white) + std::pow(noise.white, -2));
    return -0.5 * (off.dot(V.solve(off)) + of_stated) -
           V.matrixLLT().diagonal().array().log().sum();
  }
};

TEST(RowMemory, ItsGainIsThatOfTheDenseDensity) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const World world(seed, {1.1, 2.0, 60.0});
    const RowMemory found = world.Found();
    double white = -1e300;
    for (double sd = 0.5; sd < 5.0; sd *= 1.01)
      white = std::max(white, world.LogOf({sd, 0.0, 1.0}));
    EXPECT_NEAR(found.gain, world.LogOf(found.noise) - white, 0.02);
    // And no noise near it is more probable by much.
    for (const double by : {0.7, 1.4}) {
      auto [sd, slow, time] = found.noise;
      EXPECT_LT(world.LogOf({by * sd, slow, time}), world.LogOf(found.noise) + 0.1);
      EXPECT_LT(world.LogOf({sd, by * slow, time}), world.LogOf(found.noise) + 0.1);
      EXPECT_LT(world.LogOf({sd, slow, by * time}), world.LogOf(found.noise) + 0.1);
    }
  }
}

TEST(RowMemory, FindsWhatWasDrawn) {
  const estimation::NoiseMemory noise{1.0, 2.0, 50.0};
  double white = 0.0, slow = 0.0, time = 0.0;
  constexpr int kDraws = 20;
  for (unsigned seed = 0; seed < kDraws; ++seed) {
    const RowMemory found = World(10 + seed, noise).Found();
    EXPECT_GT(found.gain, kRemembers);
    white += std::log(found.noise.white / noise.white) / kDraws;
    slow += std::log(found.noise.slow / noise.slow) / kDraws;
    time += std::log(found.noise.time / noise.time) / kDraws;
  }
  EXPECT_NEAR(white, 0.0, 0.05);
  EXPECT_NEAR(slow, 0.0, 0.2);
  EXPECT_NEAR(time, 0.0, 0.4);
}

TEST(RowMemory, WhiteNoiseHasNone) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    EXPECT_LT(World(100 + seed, {1.3, 0.0, 1.0}).Found().gain, kRemembers);
  }
}

TEST(RowMemory, OfFewRowsOrWithoutTimesNothingIsSaid) {
  const World world(7, {1.0, 5.0, 50.0});
  const VectorXd none = VectorXd::Zero(kInstants);
  EXPECT_EQ(FindRowMemory({none, world.J, world.left, world.H, world.g}).gain, 0.0);
  const VectorXd few = world.times.head(20), left = world.left.head(40);
  const MatrixXd J = world.J.topRows(40);
  EXPECT_EQ(FindRowMemory({few, J, left, world.H, world.g}).gain, 0.0);
}

}  // namespace
}  // namespace abbe::fusion
