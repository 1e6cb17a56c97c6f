#include "rig/motion.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>

#include "rig/noise.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace motion_test {

constexpr Dynamics kDynamics{0.2, 0.015};

hal::SweepPlan ShortPlan() {
  hal::SweepPlan plan;
  plan.stations = {0.0, 0.001, 0.0035, 0.01};
  plan.passes = 2;
  return plan;
}

TEST(SweepMotion, NeverExceedsFeedNorAcceleration) {
  const hal::SweepPlan plan = ShortPlan();
  const SweepMotion motion(plan, kDynamics, 0.0);
  constexpr double kStep = 1e-4;
  // A difference quotient of positions rounded to 2e-18 m (eps of 10 mm) over 0.1 ms.
  constexpr double kRounding = 1e-12;
  double fastest = 0.0;
  for (double t = kStep; t < motion.duration(); t += kStep) {
    const MotionState before = motion.At(t - kStep), now = motion.At(t),
                      after = motion.At(t + kStep);
    const double speed = (now.command - before.command) / kStep;
    const double next = (after.command - now.command) / kStep;
    ASSERT_LE(std::abs(speed), plan.feed + kRounding) << t;
    ASSERT_LE(std::abs(now.position - before.position) / kStep, plan.feed + kRounding) << t;
    ASSERT_LE(std::abs(next - speed) / kStep, kDynamics.acceleration + 1e-6) << t;
    fastest = std::max(fastest, std::abs(speed));
  }
  EXPECT_NEAR(fastest, plan.feed, kRounding);
}

// The lag as a differential equation, integrated with small steps.
TEST(SweepMotion, FollowsLikeAFirstOrderLag) {
  const SweepMotion motion(ShortPlan(), kDynamics, 0.0);
  constexpr double kStep = 1e-6;
  double position = 0.0;
  for (int i = 0; i < 900'000; ++i) {
    const double t = i * kStep;
    position += kStep * (motion.At(t + 0.5 * kStep).command - position) / kDynamics.lag;
    if (i % 1000 == 0) {
      // Euler's rule: step / lag of the distance that it trails, 150 um.
      ASSERT_NEAR(motion.At(t + kStep).position, position, 150e-6 * kStep / kDynamics.lag * 2.0)
          << t;
    }
  }
}

TEST(SweepMotion, StandsLongEnoughAtEveryStationInTheOrderOfThePlan) {
  const hal::SweepPlan plan = ShortPlan();
  const SweepMotion motion(plan, kDynamics, 0.0);
  const auto visits = plan.Visits();
  ASSERT_EQ(motion.standstills().size(), visits.size());
  for (std::size_t i = 0; i < visits.size(); ++i) {
    const auto& [start, end, visit] = motion.standstills()[i];
    EXPECT_EQ(visit.station, visits[i].station);
    EXPECT_EQ(visit.direction, visits[i].direction);
    EXPECT_EQ(visit.pass, visits[i].pass);
    EXPECT_GE(end - start, plan.settle + plan.dwell);
    const MotionState settled = motion.At(start + plan.settle);
    EXPECT_EQ(settled.station, static_cast<int>(visit.station));
    EXPECT_EQ(settled.direction, visit.direction);
    EXPECT_EQ(settled.pass, visit.pass);
    EXPECT_DOUBLE_EQ(settled.command, plan.stations[visit.station]);
    EXPECT_NEAR(settled.position, plan.stations[visit.station], 0.1 * plan.window);
  }
}

TEST(SweepMotion, ApproachesEveryStationFromItsSide) {
  const hal::SweepPlan plan = ShortPlan();
  const SweepMotion motion(plan, kDynamics, 0.0);
  double least = 1.0, most = -1.0;
  for (const auto& [start, end, visit] : motion.standstills()) {
    const double before = motion.At(start - 0.02).position - plan.stations[visit.station];
    EXPECT_LT(before * visit.direction, 0.0);
  }
  for (double t = 0.0; t < motion.duration(); t += 0.01) {
    least = std::min(least, motion.At(t).command);
    most = std::max(most, motion.At(t).command);
  }
  EXPECT_NEAR(least, plan.first() - plan.overrun, 1e-12);
  EXPECT_NEAR(most, plan.last() + plan.overrun, 1e-12);
}

TEST(SweepMotion, BeginsAndEndsAtRest) {
  const SweepMotion motion(ShortPlan(), kDynamics, 0.002);
  EXPECT_EQ(motion.At(-1.0).position, 0.002);
  EXPECT_FALSE(motion.At(motion.duration() - 1e-6).done);
  EXPECT_TRUE(motion.At(motion.duration()).done);
  EXPECT_DOUBLE_EQ(motion.At(motion.duration() + 1e6).position, 0.002);
}

TEST(SlowDrift, IsAnOrnsteinUhlenbeckProcess) {
  constexpr int kSeeds = 2000;
  constexpr double kSd = 30e-9, kTime = 600.0;
  double square = 0.0, half = 0.0, full = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    SlowDrift drift({static_cast<std::uint64_t>(seed), 3}, kSd, kTime);
    const double value = drift.At(10.03);
    square += value * value;
    half += value * drift.At(10.03 + 0.5 * kTime);
    full += value * drift.At(10.03 + kTime);
  }
  // 3.5 standard deviations of a mean of products of two normals of correlation r.
  const auto band = [](double r) { return 3.5 * std::sqrt((1.0 + r * r) / kSeeds); };
  const double scale = kSeeds * kSd * kSd;
  EXPECT_NEAR(square / scale, 1.0, band(1.0));
  EXPECT_NEAR(half / scale, std::exp(-0.5), band(std::exp(-0.5)));
  EXPECT_NEAR(full / scale, std::exp(-1.0), band(std::exp(-1.0)));
}

TEST(SlowDrift, IsAFunctionOfTheTime) {
  SlowDrift forward({1, 3}, 30e-9, 600.0), backward({1, 3}, 30e-9, 600.0);
  const double early = forward.At(1.0), late = forward.At(100.0);
  EXPECT_EQ(backward.At(100.0), late);
  EXPECT_EQ(backward.At(1.0), early);
  EXPECT_NE(early, late);
}

// A grid that is kept in part says what one that is drawn anew from the beginning says.
TEST(SlowDrift, IsTheSameHoweverLongItRan) {
  SlowDrift steady({1, 3}, 30e-9, 600.0);
  std::vector<double> said;
  for (int i = 0; i < 40; ++i) said.push_back(steady.At(97.0 * i));  // 38 000 points, 4096 kept
  for (int i = 39; i >= 0; i -= 13) {
    SlowDrift once({1, 3}, 30e-9, 600.0);
    EXPECT_EQ(once.At(97.0 * i), said[static_cast<std::size_t>(i)]);
    EXPECT_EQ(steady.At(97.0 * i), said[static_cast<std::size_t>(i)]);
  }
}

TEST(SlowDrift, KeepsABoundedPartOfItsGrid) {
  const auto in_use = [] { return mallinfo2().uordblks; };
  SlowDrift drift({1, 3}, 30e-9, 600.0);
  drift.At(2000.0);
  const std::size_t before = in_use();
  drift.At(200'000.0);  // 2 million points, 16 MB
  EXPECT_LT(in_use(), before + 1'000'000);
}

TEST(SensorNoise, IsWhiteFromUpdateToUpdate) {
  RigSettings settings = DemoRig();
  settings.drift = 0.0;
  SensorNoise noise(settings, 1, 0), other_run(settings, 1, 1);
  constexpr int kTicks = 20000;
  double square = 0.0, neighbours = 0.0, probes = 0.0, runs = 0.0;
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    const double value = noise.OfProbe(0, tick, 0.0);
    square += value * value;
    neighbours += value * noise.OfProbe(0, tick + 1, 0.0);
    probes += value * noise.OfProbe(4, tick, 0.0);
    runs += value * other_run.OfProbe(0, tick, 0.0);
  }
  const double scale = kTicks * 20e-9 * 20e-9;
  EXPECT_NEAR(square / scale, 1.0, 3.5 * std::sqrt(2.0 / kTicks));
  for (const double product : {neighbours, probes, runs}) {
    EXPECT_NEAR(product / scale, 0.0, 3.5 / std::sqrt(kTicks));
  }
}

}  // namespace motion_test
}  // namespace abbe::rig
