#include "paths/circle_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "paths/circle_noise.h"
#include "random/counter_random.h"
#include "tests/paths/hand_made_path.h"

namespace abbe::paths {
namespace circle_run_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRadius = 0.02;

// From one angle to another and back; seen `radial(t)` out and with a set-up off by `offset`.
MeasuredPath Arc(double from_deg, double to_deg, const std::function<double(double)>& radial,
                 const Vector3d& offset = Vector3d::Zero()) {
  std::vector<Vector3d> way;
  const int count = static_cast<int>((to_deg - from_deg) * 4.0);
  const auto at = [&](int i) {
    const double t = (from_deg + (to_deg - from_deg) * (i + 0.5) / count) * kDegree;
    return Vector3d(kRadius * std::cos(t), kRadius * std::sin(t), 0.0);
  };
  way.reserve(2 * static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) way.push_back(at(i));
  for (int i = count - 1; i >= 0; --i) way.push_back(at(i));
  MeasuredPath path = HandMade(way, [&](const Vector3d& p) -> Vector3d {
    return p * (1.0 + radial(std::atan2(p.y(), p.x())) / kRadius) + offset;
  });
  path.pass.tail(count).setConstant(2);
  return path;
}

TEST(CircleRun, AWholeCircleIsNotPartial) {
  const auto runs = CircleRuns({Arc(0.0, 360.0, [](double t) { return 2e-6 * std::cos(3 * t); })});
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_FALSE(runs[0].Partial());
  const CircleFigures figures = EvaluateCircle(runs[0]);
  EXPECT_NEAR(figures.iso.ccw->G, 4e-6, 2e-9);
  EXPECT_TRUE(figures.iso.D && figures.ccw);
}

// An arc has the figures of the arc: the ring around it and the distances to the set-up
// centre; what is a mean of whole turns is left out.
TEST(CircleRun, PartOfACircle) {
  const Vector3d offset(5e-6, -3e-6, 0.0);
  const auto runs = CircleRuns({Arc(
      -100.0, 100.0, [](double t) { return 2e-6 * std::cos(8 * t); }, offset)});
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_TRUE(runs[0].Partial());
  EXPECT_NEAR(runs[0].Covered(1) / kDegree, 200.0, 0.1);
  // The wave pulls at the middle of the arc by a part of its 2 um.
  EXPECT_LT((runs[0].middle - offset.head<2>()).norm(), 0.5e-6);
  const CircleFigures figures = EvaluateCircle(runs[0]);
  EXPECT_NEAR(figures.iso.ccw->G, 4e-6, 0.2e-6);  // an arc of eight waves: its ring is theirs
  double highest = 0.0;
  for (double t = -100.0; t < 100.0; t += 0.1) {
    const double out = 5e-6 * std::cos(t * kDegree) - 3e-6 * std::sin(t * kDegree);
    highest = std::max(highest, out + 2e-6 * std::cos(8 * t * kDegree));
  }
  EXPECT_NEAR(figures.iso.F_max, highest, 0.01e-6);
  EXPECT_FALSE(figures.iso.D);
  EXPECT_FALSE(figures.ccw || figures.cw);
}

TEST(CircleRun, LessThanAQuarterIsRefused) {
  try {
    CircleRuns({Arc(0.0, 80.0, [](double) { return 0.0; })});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("made.csv: 320 points counter-clockwise are on 80 of 360"));
  }
}

// White noise of 0.4 um on a smooth path.
TEST(CircleNoise, IsToldFromNeighbours) {
  constexpr double kNoise = 0.4e-6;
  const random::CounterRandom noise(3, 1);
  std::uint64_t draw = 0;
  const auto runs = CircleRuns({Arc(0.0, 360.0, [&](double t) {
    return 20e-6 * std::sin(5 * t) + kNoise * noise.Normal(draw++);
  })});
  // 2880 rows, third differences of neighbours: their mean square is known to about
  // sqrt(2 * 2.5 / 2880) = 4 %, its root to 2 %.
  EXPECT_NEAR(ReadingNoise(runs[0]) / kNoise, 1.0, 0.06);
  const CircleRun twice = WithNoise(runs[0], std::sqrt(3.0) * kNoise, 1);
  EXPECT_NEAR(ReadingNoise(twice) / kNoise, 2.0, 0.12);
}

}  // namespace circle_run_test
}  // namespace abbe::paths
