// The machine that grows older, against the variances and shapes that its header states.
#include "rig/ageing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace ageing_test {

constexpr int kSeeds = 200;

// A perfect machine that only ages.
RigSettings Walking() {
  RigSettings settings = PerfectRig();
  settings.ageing.walk.yaw = 2e-6;
  settings.ageing.walk.squareness = 3e-6;
  settings.ageing.walk.scale = 4e-6;
  return settings;
}

RigSettings Warming() {
  RigSettings settings = PerfectRig();
  settings.ageing.by_kelvin.scale = 12e-6;
  settings.ageing.by_kelvin.straightness = 0.2e-6;
  settings.ageing.swing = 2.0;
  settings.ageing.lag = 3600.0;
  return settings;
}

TEST(Ageing, OnTheFirstDayTheMachineIsAsItWasDrawn) {
  const RigSettings settings = DemoRig();
  const World fresh(settings, 5);
  const World first = Ageing(settings, 5).WorldAt(0.0);
  for (const double x : {0.0, 0.017, 0.06}) EXPECT_EQ(fresh.ErrorsOf(0, x), first.ErrorsOf(0, x));
  EXPECT_EQ(fresh.squareness().c0y, first.squareness().c0y);
}

TEST(Ageing, WalksBySquareRootsOfDays) {
  const RigSettings settings = Walking();
  for (const double days : {1.0, 9.0}) {
    double yaw = 0.0, square = 0.0, scale = 0.0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const World world = Ageing(settings, seed).WorldAt(days);
      // An angle counts from the first end: the difference of two places far apart, variance 2.
      yaw += std::pow(world.ErrorsOf(0, 0.06)[5], 2) / 2.0;
      square += std::pow(world.squareness().c0y, 2);
      scale += std::pow(world.ScaleOf(1), 2);
    }
    const double scatter = 4.0 * std::sqrt(2.0 / kSeeds);
    EXPECT_NEAR(yaw / kSeeds / (days * 4e-12), 1.0, scatter) << days;
    EXPECT_NEAR(square / kSeeds / (days * 9e-12), 1.0, scatter) << days;
    EXPECT_NEAR(scale / kSeeds / (days * 16e-12), 1.0, scatter) << days;
  }
}

TEST(Ageing, BetweenTwoStepsGoesStraight) {
  const Ageing ageing(Walking(), 3);
  const double at = 0.03;
  const double before = ageing.WorldAt(0.5).ErrorsOf(0, at)[5];
  const double after = ageing.WorldAt(0.75).ErrorsOf(0, at)[5];
  EXPECT_NEAR(ageing.WorldAt(0.625).ErrorsOf(0, at)[5], 0.5 * (before + after), 1e-15);
}

TEST(Ageing, GrowsAndBendsWithTheLaggedTemperature) {
  const Ageing ageing(Warming(), 7);
  const double day = 0.3;
  const double warmer = ageing.LaggedAt(day) - ageing.LaggedAt(0.0);
  ASSERT_GT(std::abs(warmer), 0.3);
  const World world = ageing.WorldAt(day), other = ageing.WorldAt(0.8);
  const double ratio = (ageing.LaggedAt(0.8) - ageing.LaggedAt(0.0)) / warmer;
  EXPECT_NEAR(other.ErrorsOf(0, 0.06)[0], ratio * world.ErrorsOf(0, 0.06)[0], 1e-15);
  // A straightness is zero at the first end and has no slope over the travel.
  double slope = 0.0;
  constexpr int kCells = 2000;
  for (int i = 0; i < kCells; ++i) {
    const double s = (i + 0.5) / kCells;
    slope += (s - 0.5) * world.ErrorsOf(0, 0.06 * s)[1];
  }
  EXPECT_EQ(world.ErrorsOf(0, 0.0)[1], 0.0);
  EXPECT_NEAR(12.0 * slope / kCells, 0.0, 1e-12);
  double largest = 0.0;
  for (const double x : {0.015, 0.03, 0.045}) {
    largest = std::max(largest, std::abs(world.ErrorsOf(0, x)[1]));
  }
  EXPECT_GT(largest, 1e-10);  // of 0.2 um for each kelvin
}

TEST(Ageing, TheLaggedTemperatureObeysItsEquation) {
  const Ageing ageing(Warming(), 2);
  const double lag = 3600.0, seconds = 30.0;
  double worst = 0.0;
  for (double day = 0.1; day < 2.0; day += 0.037) {
    const double step = seconds / 86400.0;
    const double rate = (ageing.LaggedAt(day + step) - ageing.LaggedAt(day - step)) / (2 * seconds);
    const double expected = (ageing.TemperatureAt(day) - ageing.LaggedAt(day)) / lag;
    worst = std::max(worst, std::abs(rate - expected));
  }
  // The slope of the room changes at full hours: by 2 K times (2 pi / 24 h)^2 in an hour.
  EXPECT_LT(worst, 1e-6);
}

TEST(Ageing, RefusesDaysItDoesNotKnow) {
  const Ageing ageing(Walking(), 1);
  EXPECT_THROW(ageing.WorldAt(-1.0), InputError);
  EXPECT_THROW(ageing.WorldAt(kLastDay + 1.0), InputError);
}

}  // namespace ageing_test
}  // namespace abbe::rig
