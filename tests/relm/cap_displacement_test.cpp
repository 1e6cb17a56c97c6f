#include "relm/cap_displacement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "failure/failure.h"

namespace abbe::relm {
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

// Strokes of one sense agree to +-0.3 um in turn: the scatter is that, and a stroke counts as one.
TEST(CapDisplacement, UncertaintyComesFromTheStrokes) {
  int row = 0;
  const auto made = Strokes(0.0, 8, [&row](int sense) {
    const bool high = row++ / 600 % 2 == 0;
    return std::pair{-sense * 1.0 + (high ? 0.3 : -0.3), 0.0};
  });
  const auto found = EvaluateCap(made, {{'X', 1.0, "probe_d_um"}});
  EXPECT_NEAR(found.at(0).scatter, 0.3e-6, 0.01e-6);
  EXPECT_NEAR(found.at(0).u, 0.3e-6 / std::sqrt(8.0), 0.01e-6);
}

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
}  // namespace abbe::relm
