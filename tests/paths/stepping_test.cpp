#include "paths/stepping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "tests/paths/hand_made_path.h"

namespace abbe::paths {
namespace stepping_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kRounding = 1e-15;  // m
constexpr double kStep = 5e-3;

// 0, 5, ... 25 mm along an axis and back, 20 rows at each stop, 9 on each way.
std::vector<Vector3d> Line(int axis, const Vector3d& from) {
  std::vector<Vector3d> path;
  for (int stop = 0; stop <= 10; ++stop) {
    const Vector3d place = from + kStep * (stop <= 5 ? stop : 10 - stop) * Vector3d::Unit(axis);
    path.insert(path.end(), 20, place);
    if (stop == 10) break;
    const Vector3d next = from + kStep * (stop < 5 ? stop + 1 : 9 - stop) * Vector3d::Unit(axis);
    Go(path, place, next, 9);
  }
  return path;
}

TEST(SteppingTest, AScaleErrorGrowsWithTheStepsAndAnOffsetDoesNotMatter) {
  const Vector3d offset(3e-4, -2e-4, 1e-4);
  const auto lines = EvaluateStepping(
      HandMade(Line(0, {0.01, 0.02, 0.03}), [&offset](const Vector3d& p) -> Vector3d {
        return p + offset + Vector3d(1e-4 * p.x(), 0.0, 2e-5 * p.x());
      }));
  ASSERT_EQ(lines.size(), 1U);
  const SteppingLine& line = lines.front();
  EXPECT_EQ(line.axis, 'X');
  ASSERT_EQ(line.stops.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const double along = kStep * static_cast<double>(i);
    EXPECT_NEAR(line.stops[i].commanded, along, kRounding);
    EXPECT_LT((line.stops[i].deviation - along * Vector3d(1e-4, 0.0, 2e-5)).norm(), kRounding);
    EXPECT_EQ(line.stops[i].visits, i == 5 ? 1 : 2);
  }
  EXPECT_NEAR(line.largest_along, 2.5e-6, kRounding);
  EXPECT_NEAR(line.largest, 25e-3 * std::hypot(1e-4, 2e-5), kRounding);
}

// Three times to and fro; each visit stands 0.3 um off, at random.
TEST(SteppingTest, WhatVisitsDifferByIsInTheUncertainty) {
  constexpr double kRepeats = 0.3e-6;
  double squares = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const random::CounterRandom draw(seed, 1);
    std::vector<Vector3d> path;
    for (int time = 0; time < 3; ++time) {
      const auto line = Line(0, Vector3d::Constant(0.01));
      path.insert(path.end(), line.begin(), line.end());
    }
    std::uint64_t visit = 0;
    Vector3d last = Vector3d::Zero();
    const auto lines = EvaluateStepping(HandMade(path, [&](const Vector3d& p) -> Vector3d {
      if (p != last) ++visit;
      last = p;
      return p + kRepeats * Vector3d(draw.Normal(3 * visit), draw.Normal(3 * visit + 1),
                                     draw.Normal(3 * visit + 2));
    }));
    ASSERT_EQ(lines.size(), 1U);
    for (const SteppingStop& stop : lines.front().stops) {
      if (stop.commanded == 0.0) continue;
      for (const int axis : {1, 2}) squares += std::pow(stop.deviation[axis] / stop.u, 2);
      count += 2.0;
    }
  }
  // The mean of 500 squares of normal numbers; the five stops of a line share their first one.
  EXPECT_NEAR(squares / count, 0.95, 0.25);
}

TEST(SteppingTest, EachAxisHasItsLine) {
  std::vector<Vector3d> path;
  const Vector3d start = Vector3d::Constant(0.01);
  for (int axis = 0; axis < 3; ++axis) {
    const auto line = Line(axis, start);
    path.insert(path.end(), line.begin(), line.end());
  }
  const auto lines = EvaluateStepping(HandMade(path, [](const Vector3d& p) { return p; }));
  ASSERT_EQ(lines.size(), 3U);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(lines[axis].axis, "XYZ"[axis]);
    EXPECT_EQ(lines[axis].stops.size(), 6U);
    EXPECT_LT(lines[axis].largest, kRounding);
  }
}

// Rows scatter by +-1 um in turn along x alone. A stop has 21 rows, of which 16 count, the last one
// 20 and 15; first and third stop are visited twice.
TEST(SteppingTest, UncertaintyFollowsTheScatter) {
  std::vector<Vector3d> path = Line(1, Vector3d::Zero());
  int row = 0;
  const auto lines = EvaluateStepping(HandMade(path, [&row](const Vector3d& p) -> Vector3d {
    return p + Vector3d(++row % 2 == 0 ? 1e-6 : -1e-6, 0.0, 0.0);
  }));
  const SteppingStop& stop = lines.front().stops[2];
  // For one coordinate, the mean of three; 15 readings have a mean of 1/15 um.
  const double of_16 = 1e-12 * 16.0 / 15.0 / 3.0 / 16.0;
  const double of_15 = 1e-12 * (15.0 - 1.0 / 15.0) / 14.0 / 3.0 / 15.0;
  EXPECT_NEAR(stop.u, std::sqrt((2.0 * of_16 + of_16 + of_15) / 4.0), 1e-6 * stop.u);
}

TEST(SteppingTest, RefusesAPathThatNeverStops) {
  std::vector<Vector3d> path;
  Go(path, Vector3d::Zero(), {0.01, 0.02, 0.0}, 500);
  try {
    EvaluateStepping(HandMade(path, [](const Vector3d& p) { return p; }));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("made.csv: 0 stops"));
  }
}

}  // namespace stepping_test
}  // namespace abbe::paths
