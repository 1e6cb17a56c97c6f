#include "recording/ballbar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "failure/failure.h"
#include "paths/circle_run.h"
#include "paths/measured_path.h"

namespace abbe::paths {
namespace ballbar_test {

using recording::BallbarCircle;
using recording::BallbarOf;
using recording::Recording;
using ::testing::HasSubstr;

// Both senses, a point a degree; `deviation_um` of angle and sense.
Recording Table(const std::function<double(double, int)>& deviation_um) {
  Recording table;
  table.name = "xy.csv";
  table.header = "kind = \"linkage\"\ntime = \"order\"\n";
  table.columns = {{"time_s", {}}, {"angle_deg", {}}, {"deviation_um", {}}, {"flags", {}}};
  for (int i = 0; i < 721; ++i) {
    const int sense = i <= 360 ? 1 : -1;
    const double degrees = sense > 0 ? i : 720 - i;
    const double row[] = {static_cast<double>(i), degrees,
                          deviation_um(degrees * std::numbers::pi / 180.0, sense), 0.0};
    for (int k = 0; k < 4; ++k) table.columns[k].values.push_back(row[k]);
  }
  return table;
}

std::string Refusal(const Recording& table, const BallbarCircle& circle) {
  try {
    BallbarOf(table, circle);
  } catch (const InputError& failure) {
    return failure.what();
  }
  return "accepted";
}

// A set-up 8 um off the centre, a radius 3 um too large, and axes 20 um / 150 mm from square:
// r = R + 8 cos t + 3 - 10 sin 2t. The ring of sin 2t alone is 20 um wide, its centre the one of
// the circle (ISO 230-4; the sine of the angle between the axes: docs/circle.md).
TEST(Ballbar, FiguresFollowFromTheRadiusAlone) {
  const Recording ballbar = BallbarOf(
      Table([](double t, int) { return 8.0 * std::cos(t) + 3.0 - 10.0 * std::sin(2 * t); }),
      {.radius_mm = 150.0, .plane = "YZ", .feed_mm_min = 1000.0});
  const MeasuredPath path = BallbarPath(ballbar);
  EXPECT_EQ(path.instrument, "ballbar");
  EXPECT_EQ(path.seen, (std::array<bool, 3>{false, true, true}));
  const auto runs = CircleRuns({path});
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].plane.name, "YZ");
  EXPECT_NEAR(runs[0].radius, 0.150, 1e-12);
  EXPECT_NEAR(runs[0].feed, 1.0 / 60.0, 1e-12);
  EXPECT_NEAR(runs[0].middle.x(), 8e-6, 1e-9);
  EXPECT_NEAR(runs[0].middle.y(), 0.0, 1e-9);
  const CircleFigures figures = EvaluateCircle(runs[0]);
  ASSERT_TRUE(figures.iso.both && figures.iso.D);
  EXPECT_NEAR(figures.iso.both->G, 20e-6, 1e-8);  // second order of 8 um: 0.2 nm
  EXPECT_NEAR(*figures.iso.D, 3e-6, 1e-9);
  EXPECT_NEAR(figures.iso.ccw->G, 20e-6, 1e-8);
}

// Descending angles are the clockwise sense, which is 4 um smaller here.
TEST(Ballbar, TheOrderOfTheAnglesIsTheSense) {
  const auto runs = CircleRuns({BallbarPath(
      BallbarOf(Table([](double, int sense) { return 2.0 * sense; }), {.radius_mm = 100.0}))});
  ASSERT_EQ(runs.size(), 1u);
  for (const CirclePoint& point : runs[0].points) {
    EXPECT_NEAR(std::hypot(point.first, point.second), 0.100 + 2e-6 * point.sense, 1e-9);
  }
  EXPECT_TRUE(runs[0].Has(1) && runs[0].Has(-1));
  EXPECT_NEAR(EvaluateCircle(runs[0]).iso.both->G, 4e-6, 1e-8);
}

TEST(Ballbar, RadiiInsteadOfDeviationsAreTaken) {
  Recording table = Table([](double, int) { return 0.0; });
  table.columns[2] = {"ref_radius_mm", std::vector<double>(721, 100.005)};
  const auto runs = CircleRuns({BallbarPath(BallbarOf(table, {.radius_mm = 100.0}))});
  EXPECT_NEAR(*EvaluateCircle(runs[0]).iso.D, 5e-6, 1e-9);
}

TEST(Ballbar, ItsLengthIsAsWellKnownAsTheHeaderSays) {
  Recording ballbar = BallbarOf(Table([](double, int) { return 0.0; }), {.radius_mm = 100.0});
  EXPECT_FALSE(CircleRuns({BallbarPath(ballbar)}).front().u_length);
  const std::string header = ballbar.header;
  ballbar.header = "u_length_um = 0.5\n" + header;
  EXPECT_NEAR(*CircleRuns({BallbarPath(ballbar)}).front().u_length, 0.5e-6, 1e-15);
  ballbar.header = "u_length_um = -0.5\n" + header;
  EXPECT_THROW(BallbarPath(ballbar), InputError);
}

TEST(Ballbar, WhatIsNoCircleIsRefused) {
  Recording table = Table([](double, int) { return 0.0; });
  EXPECT_THAT(Refusal(table, {.radius_mm = 0.0}), HasSubstr("give the programmed radius"));
  EXPECT_THAT(Refusal(table, {.radius_mm = 100.0, .plane = "XX"}),
              HasSubstr("choose XY, YZ or ZX"));
  table.columns[2].name = "error_um";
  EXPECT_THAT(Refusal(table, {.radius_mm = 100.0}), HasSubstr("no column deviation_um"));
  table.columns[1].name = "angle";
  EXPECT_THAT(Refusal(table, {.radius_mm = 100.0}), HasSubstr("no column angle_deg"));
}

}  // namespace ballbar_test
}  // namespace abbe::paths
