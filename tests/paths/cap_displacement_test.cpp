#include "paths/cap_displacement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "standards/student_coverage.h"
#include "tests/pull_statistics.h"

namespace abbe::paths {
namespace cap_displacement_test {

using ::testing::HasSubstr;

// Strokes to and fro along a direction in XY, at constant speed; the gauges read by a formula of
// the sense.
recording::Recording Strokes(double angle, int strokes,
                             const std::function<std::pair<double, double>(int)>& gauges_um) {
  recording::Recording made{"cap.csv",
                            "kind = \"linkage\"\n",
                            {{"time_s", {}},
                             {"x_mm", {}},
                             {"y_mm", {}},
                             {"z_mm", {}},
                             {"pass", {}},
                             {"feed_mm_min", {}},
                             {"probe_d_um", {}},
                             {"probe_e_um", {}},
                             {"cap_force_n", {}},
                             {"flags", {}}},
                            {}};
  constexpr double kStep = 0.01;  // mm a row
  double along = 0.0, time = 0.0;
  for (int stroke = 0; stroke < strokes; ++stroke) {
    const int sense = stroke % 2 == 0 ? 1 : -1;
    for (int row = 0; row < 300; ++row) {
      along += sense * kStep;
      time += 0.01;
      const auto [d, e] = gauges_um(sense);
      const double values[] = {time,
                               along * std::cos(angle),
                               along * std::sin(angle),
                               0.0,
                               double(stroke),
                               60.0,
                               d,
                               e,
                               8.5,
                               0.0};
      for (std::size_t i = 0; i < 10; ++i) made.columns[i].values.push_back(values[i]);
    }
  }
  return made;
}

// The ball trails by 1.2 um: against the motion at 30 degrees.
TEST(CapDisplacement, TwoGaugesTellADragInTheirPlane) {
  constexpr double kAngle = 0.5236, kDrag = 1.2;
  const auto made = Strokes(kAngle, 6, [](int sense) {
    return std::pair{80.0 - sense * kDrag * std::cos(kAngle),
                     -50.0 + sense * kDrag * std::sin(kAngle)};
  });
  // The second gauge falls where the ball goes along y.
  const auto found = EvaluateCap(made, {{'X', 1.0, "probe_d_um"}, {'Y', -1.0, "probe_e_um"}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].force, 8.5);
  EXPECT_NEAR(found[0].feed, 1e-3, 1e-15);
  // Rows whose velocity is taken over a turn are left out, or count with the sense that prevails.
  EXPECT_NEAR(found[0].displacement, kDrag * 1e-6, 0.01e-6);
  EXPECT_GT(found[0].rows, 1700U);
}

TEST(CapDisplacement, NoFrictionIsNone) {
  const auto made = Strokes(0.0, 4, [](int) { return std::pair{80.0, 0.0}; });
  const auto found = EvaluateCap(made, {{'X', 1.0, "probe_d_um"}});
  EXPECT_LT(std::abs(found.at(0).displacement), 1e-18);
  EXPECT_LT(found.at(0).scatter, 1e-18);
}

// Strokes of one sense agree to +-0.3 um in turn; one line of 8 leaves 6 degrees of freedom.
TEST(CapDisplacement, UncertaintyComesFromTheStrokes) {
  int row = 0;
  const auto made = Strokes(0.0, 8, [&row](int sense) {
    const bool high = row++ / 600 % 2 == 0;
    return std::pair{-sense * 1.0 + (high ? 0.3 : -0.3), 0.0};
  });
  const auto found = EvaluateCap(made, {{'X', 1.0, "probe_d_um"}});
  EXPECT_NEAR(found.at(0).scatter, 0.3e-6, 0.01e-6);
  EXPECT_EQ(found.at(0).dof, 6.0);
  EXPECT_NEAR(found.at(0).u, 0.3e-6 * std::sqrt(8.0 / 6.0) / std::sqrt(8.0), 0.01e-6);
}

TEST(CapDisplacement, TwoStrokesTellNoUncertainty) {
  const auto made = Strokes(0.0, 2, [](int sense) { return std::pair{-sense * 1.0, 0.0}; });
  const auto found = EvaluateCap(made, {{'X', 1.0, "probe_d_um"}});
  EXPECT_NEAR(found.at(0).displacement, 1e-6, 0.01e-6);
  EXPECT_EQ(found.at(0).dof, 0.0);
  EXPECT_TRUE(std::isinf(found.at(0).u));
}

// Sides of a square, once counter-clockwise, once clockwise: each side is seen off by another
// amount, the same both ways.
TEST(CapDisplacement, WhatErrsAlikeToAndFroFallsOut) {
  const double off_um[] = {3.0, -1.0, 0.5, 2.0};
  auto made = Strokes(0.0, 8, [](int) { return std::pair{0.0, 0.0}; });
  auto &x = made.columns[1], &y = made.columns[2], &d = made.columns[6], &e = made.columns[7];
  const double corner[][2] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
  for (std::size_t stroke = 0; stroke < 8; ++stroke) {
    const bool back = stroke >= 4;
    const std::size_t side = back ? 7 - stroke : stroke;
    const double* from = corner[back ? (side + 1) % 4 : side];
    const double* to = corner[back ? side : (side + 1) % 4];
    for (std::size_t row = 0; row < 300; ++row) {
      const std::size_t at = 300 * stroke + row;
      x.values[at] = from[0] + (to[0] - from[0]) * static_cast<double>(row) / 300.0;
      y.values[at] = from[1] + (to[1] - from[1]) * static_cast<double>(row) / 300.0;
      d.values[at] = off_um[side] - 1.2 * (to[0] - from[0]) / 3.0;
      e.values[at] = -off_um[side] - 1.2 * (to[1] - from[1]) / 3.0;
    }
  }
  const auto found = EvaluateCap(made, {{'X', 1.0, "probe_d_um"}, {'Y', 1.0, "probe_e_um"}});
  EXPECT_EQ(found.at(0).dof, 8.0 - 4.0 - 1.0);
  EXPECT_NEAR(found.at(0).displacement, 1.2e-6, 0.02e-6);
  EXPECT_LT(found.at(0).u, 0.02e-6);
}

// How often U95 holds the drag, and whether the variance stated is that of the errors, with rows
// that scatter by 0.6 um over a form of 3 um, and strokes that differ by `of_strokes` besides.
void ExpectCoverage(double of_strokes_um) {
  constexpr int kRecordings = 400, kStrokes = 5;
  constexpr double kDrag = 1.2, kRows = 0.6, kForm = 3.0;
  Mean inside, stated, square;
  for (std::uint64_t seed = 1; seed <= kRecordings; ++seed) {
    const random::CounterRandom noise(seed, 0xCA9);
    std::uint64_t row = 0;
    const auto made = Strokes(0.0, kStrokes, [&](int sense) {
      const std::uint64_t stroke = row / 300;
      const double way = static_cast<double>(row % 300 + 1) / 300.0;
      const double place = sense > 0 ? way : 1.0 - way;
      ++row;
      return std::pair{80.0 + kForm * std::cos(2.0 * std::numbers::pi * place) - sense * kDrag +
                           kRows * noise.Normal(row) +
                           of_strokes_um * noise.Normal(1'000'000 + stroke),
                       0.0};
    });
    const CapDisplacement found = EvaluateCap(made, {{'X', 1.0, "probe_d_um"}}).at(0);
    const double off = 1e6 * found.displacement - kDrag, u = 1e6 * found.u;
    inside.Add(std::abs(off) < standards::StudentCoverage(found.dof) * u ? 1.0 : 0.0);
    stated.Add(u * u);
    square.Add(off * off);
  }
  EXPECT_NEAR(inside.mean(), 0.95, k99 * std::sqrt(0.95 * 0.05 / kRecordings));
  EXPECT_NEAR(stated.mean() / square.mean(), 1.0,
              k99 * std::hypot(stated.error() / stated.mean(), square.error() / square.mean()));
}

TEST(CapDisplacement, U95HoldsWhereRowsScatter) { ExpectCoverage(0.0); }
TEST(CapDisplacement, U95HoldsWhereStrokesScatter) { ExpectCoverage(0.2); }

TEST(CapDisplacement, RefusesOneDirectionAndNoMotion) {
  const auto refusal = [](const recording::Recording& made) -> std::string {
    try {
      EvaluateCap(made, {{'X', 1.0, "probe_d_um"}});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto still = [](int) { return std::pair{0.0, 0.0}; };
  EXPECT_THAT(refusal(Strokes(0.0, 1, still)), HasSubstr("cap.csv: at 60 mm/min"));
  auto standing = Strokes(0.0, 2, still);
  for (double& x : standing.columns[1].values) x = 1.0;
  EXPECT_THAT(refusal(standing), HasSubstr("stand still"));
}

}  // namespace cap_displacement_test
}  // namespace abbe::paths
