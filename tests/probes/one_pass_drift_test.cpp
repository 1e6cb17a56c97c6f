// What one pass shows and hides of drift and reversal.
#include "probes/one_pass_drift.h"

#include <gtest/gtest.h>

#include "tests/probes/changed_sweep.h"

namespace abbe::probes {
namespace one_pass_drift_test {

SyntheticSweep OnePass(std::uint64_t seed) {
  return {.stations = 13, .passes = 1, .samples = 10, .white = 20e-9, .drift = 30e-9, .seed = seed};
}

constexpr const char* kDiffer = "one pass: forward and backward differ beyond [noise]";

// The mean of both directions is wrong by the part of a drift that is even about the turn, which is
// in no difference: here e^-2 cosh of it, up to 0.75 um for 2 um.
TEST(OnePassDrift, ProbesThatWarmUpAreCoveredAndTold) {
  constexpr PerProbe<> kWarm = {2.0, -1.0, 1.5, 1.0, -2.0};  // um
  for (const double fades : {0.1, 0.25, 1.0}) {
    InsideU95 inside;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const SyntheticSweep sweep = OnePass(seed);
      const SweepSetup setup = SetupOfNoiseOnly();
      const auto warming = WithAdded(Record(sweep, setup), [&](std::size_t probe, double share) {
        return -kWarm[probe] * std::expm1(-share / fades);
      });
      const SweepResult result = ReduceSweep(warming, setup);
      inside.Add(sweep, result);
      EXPECT_TRUE(Tells(result, kDiffer)) << seed;
      EXPECT_TRUE(Tells(result, "probe_d by ")) << seed;
      for (const auto& component : result.components) EXPECT_FALSE(component.reversal->seen);
    }
    EXPECT_GT(inside.share(), 0.95) << fades;
  }
}

// An Ornstein-Uhlenbeck drift of 150 nm and 5 s where 30 nm and 600 s are stated.
TEST(OnePassDrift, AFasterAndLargerDriftIsCovered) {
  InsideU95 inside;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const SyntheticSweep sweep = OnePass(seed);
    const SweepSetup setup = SetupOfNoiseOnly();
    recording::Recording recording = Record(sweep, setup);
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      const random::CounterRandom random(seed, 500 + probe);
      double drift = random.Normal(0);
      std::uint64_t index = 1;
      const double kept = std::exp(-0.005 / 5.0);  // rows come every 5 ms
      for (double& gap : recording.columns[kFirstGapColumn + probe].values) {
        gap += 0.15 * drift;
        drift = kept * drift + std::sqrt(1.0 - kept * kept) * random.Normal(index++);
      }
    }
    inside.Add(sweep, ReduceSweep(recording, setup));
  }
  EXPECT_GT(inside.share(), 0.90);
}

TEST(OnePassDrift, AsStatedNothingIsSaid) {
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const SweepSetup setup = SetupOfNoiseOnly();
    told += Tells(ReduceSweep(Record(OnePass(seed), setup), setup), kDiffer) ? 1 : 0;
  }
  EXPECT_LE(told, 4);  // one in a hundred: more in 0.04 % of all suites
}

// A reversal that is the same all along cannot be a slow drift, for it is there at the turn too.
TEST(OnePassDrift, AReversalIsTakenForOneAndDoubted) {
  SyntheticSweep sweep = OnePass(3);
  const auto without = sweep.errors;
  sweep.errors = [&](double d, int direction) {
    HeadErrors<> errors = without(d, direction);
    errors.ezx += direction * 1e-6;
    return errors;
  };
  const SweepResult result = ReduceSweep(Record(sweep, SetupOfNoiseOnly()), SetupOfNoiseOnly());
  EXPECT_TRUE(result.components[4].reversal->seen);
  EXPECT_NEAR(result.components[4].reversal->mean.value, 2e-6, 0.1e-6);
  EXPECT_TRUE(Tells(result, "one pass: forward and backward of EZX"));
  EXPECT_FALSE(Tells(result, kDiffer));
}

// Forward 0 1 2 s, backward 3 4 5 s; groups station by station.
TEST(OnePassDrift, OnlyWhatIsNotConstantCountsAsDrift) {
  Eigen::VectorXd time(8), gap(8);
  time << 0.0, 7.0, 1.0, 6.0, 2.0, 5.0, 3.0, 4.0;
  gap << 5.0, 0.0, 2.0, -3.0, 9.0, 4.0, 1.0, -4.0;  // all differences are 5
  const Eigen::MatrixXd noise = Eigen::MatrixXd::Identity(8, 8) * 1e-4;
  EXPECT_FALSE(DriftOfOnePass(time, gap, noise));
  gap[0] += 2.0;
  const auto drift = DriftOfOnePass(time, gap, noise);
  ASSERT_TRUE(drift);
  EXPECT_EQ(drift->station, 0);
  // 2 at one of four, its mean taken off: 3; the differences have the variance 2e-4; 3 are free.
  EXPECT_NEAR(drift->times, std::sqrt(3.0 / 2e-4 / 3.0), 1e-6);
  EXPECT_GT(drift->covariance.diagonal().minCoeff(), 0.1);
}

}  // namespace one_pass_drift_test
}  // namespace abbe::probes
