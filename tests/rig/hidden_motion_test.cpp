// Each hidden effect of the axes against its closed form, as a reference instrument sees it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rig/dragged.h"
#include "tests/rig/hidden_worlds.h"

namespace abbe::rig {
namespace hidden_motion_test {

using Eigen::Vector3d;

constexpr double kRounding = 1e-15;  // m, of places of 0.1 m

// There and back along a slanting line, recorded on the way.
recording::Recording ThereAndBack(const HiddenEffects& hidden, CourseOptions options = {}) {
  const Vector3d from(0.01, 0.02, 0.03), to(0.03, 0.04, 0.05);
  options.kind = "reference";
  return PerfectLinkageRig(hidden).Record(LineCourse({from, to, from}, 0.01, 0.3, 1), options);
}

TEST(Play, StaysWithinItsWidth) {
  Play play(6.0);
  EXPECT_EQ(play.Follow(0.0), 0.0);
  EXPECT_EQ(play.Follow(2.0), 0.0);   // half a width ahead at most
  EXPECT_EQ(play.Follow(10.0), 7.0);  // lags by half of the width
  EXPECT_EQ(play.Follow(8.0), 7.0);   // taken up first
  EXPECT_EQ(play.Follow(3.0), 6.0);
  EXPECT_EQ(play.Follow(3.0), 6.0);
}

TEST(HiddenMotion, BacklashLagsByHalfInEachDirection) {
  const auto path = ThereAndBack(Hide({"backlash:object=X:width_um=6"}));
  const auto x = Deviations(path, 'x'), y = Deviations(path, 'y');
  const auto position = path.At("x_mm"), direction = path.At("direction");
  double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(y[i], 0.0, kRounding);
    if (position[i] < 10.1 || position[i] > 29.9) continue;  // being taken up
    EXPECT_NEAR(x[i], -direction[i] * 3e-6, kRounding);
    sum[direction[i] > 0.0] += x[i];
    ++count[direction[i] > 0.0];
  }
  EXPECT_NEAR(sum[1] / count[1] - sum[0] / count[0], -6e-6, kRounding);  // ISO mean reversal
}

TEST(HiddenMotion, CyclicAndScaleAddToTheirAxis) {
  const auto path =
      ThereAndBack(Hide({"leadscrew-cyclic:object=Y:pitch_mm=5:amplitude_um=2:phase_rad=0.5",
                         "scale-error:object=Z:gain_ppm=100"}));
  const auto y = Deviations(path, 'y'), z = Deviations(path, 'z');
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double at = path.At("y_mm")[i];
    EXPECT_NEAR(y[i], 2e-6 * std::sin(2.0 * std::numbers::pi * at / 5.0 + 0.5), kRounding);
    EXPECT_NEAR(z[i], 100e-6 * 1e-3 * path.At("z_mm")[i], kRounding);
  }
}

TEST(HiddenMotion, GrowthFollowsItsSensorFromTheStart) {
  RigSettings settings = PerfectMachine();
  settings.temperature_drift = 0.1;
  Climate climate(settings, 1, 3, {"temp_column_c", "temp_table_c"});
  climate.Warm(2.0);
  const auto path =
      ThereAndBack(Hide({"thermal-growth:object=X:coefficient_ppm_per_c=10:sensor=temp_table_c"}),
                   {.sensors = {"temp_column_c"}, .begin = 500.0, .climate = &climate});
  const auto x = Deviations(path, 'x');
  const auto temperature = path.At("temp_table_c"), column = path.At("temp_column_c");
  const double start = climate.At("temp_table_c", 0.0) - 2.0;
  EXPECT_NE(temperature[0], column[0]);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double grown = 10e-6 * (temperature[i] - start) * 1e-3 * path.At("x_mm")[i];
    EXPECT_NEAR(x[i], grown, kRounding);
    EXPECT_GT(temperature[i] - start, 1.0);
  }
}

TEST(HiddenMotion, WarmUpGoesOnThroughACampaign) {
  const auto path = ThereAndBack(
      Hide({"warm-up-drift:object=X:amplitude_um=-4:time_constant_s=600"}), {.begin = 300.0});
  const auto x = Deviations(path, 'x');
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double time = 300.0 + path.At("time_s")[i];
    EXPECT_NEAR(x[i], -4e-6 * (1.0 - std::exp(-time / 600.0)), kRounding);
  }
}

// A full circle of 20 mm at 10 mm/s: the axes run at r w, w = 0.5 rad/s, and the scales show where
// the controller believes them.
recording::Recording Circle(const HiddenEffects& hidden) {
  return PerfectLinkageRig(hidden).Record(
      CircleCourse({.centre = {0.03, 0.03, 0.03}, .radius = 0.02, .feed = 0.01}),
      {.kind = "reference"});
}
constexpr double kOmega = 0.5;
// The braking of the last move and steps of a millisecond.
constexpr double kOnCircle = 1e-3;

TEST(HiddenMotion, ServoLagTurnsACircleBack) {
  const double delay = 2e-3;
  const auto path =
      Circle(Hide({"servo-lag:object=X:delay_ms=2", "servo-lag:object=Y:delay_ms=2"}));
  const auto dx = Deviations(path, 'x'), dy = Deviations(path, 'y');
  for (std::size_t i = 0; i < dx.size(); ++i) {
    const Vector3d arm(1e-3 * path.At("x_mm")[i] - 0.03, 1e-3 * path.At("y_mm")[i] - 0.03, 0.0);
    const Vector3d off(dx[i], dy[i], 0.0);
    const Vector3d along = path.At("direction")[i] * Vector3d::UnitZ().cross(arm).normalized();
    // Behind by delay * speed; the radius grows by the square of that only.
    EXPECT_NEAR(off.dot(along), -delay * kOmega * arm.norm(), kOnCircle * delay * 0.01);
    EXPECT_NEAR(off.dot(arm.normalized()), 0.0, kOnCircle * delay * 0.01);
  }
}

TEST(HiddenMotion, MismatchSharesItsDelayBetweenTwoAxes) {
  const double delay = 2e-3;
  const auto path = Circle(Hide({"servo-lag-mismatch:object=XY:delay_ms=2"}));
  const auto dx = Deviations(path, 'x'), dy = Deviations(path, 'y');
  for (std::size_t i = 0; i < dx.size(); ++i) {
    const double arm_x = 1e-3 * path.At("x_mm")[i] - 0.03, arm_y = 1e-3 * path.At("y_mm")[i] - 0.03;
    const double sense = path.At("direction")[i];
    // Speeds: (-arm_y, arm_x) times sense and w.
    EXPECT_NEAR(dx[i], 0.5 * delay * sense * kOmega * -arm_y, kOnCircle * delay * 0.01);
    EXPECT_NEAR(dy[i], -0.5 * delay * sense * kOmega * arm_x, kOnCircle * delay * 0.01);
  }
}

TEST(HiddenMotion, SpikeStandsAlongTheOldDirectionAfterATurn) {
  const auto path = ThereAndBack(Hide({"reversal-spike:object=X:height_um=5:decay_mm=2"}));
  const auto x = Deviations(path, 'x');
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double since = 1e-3 * (30.0 - path.At("x_mm")[i]);
    // An axis has turned when it has come back by 10 nm.
    if (path.At("direction")[i] < 0.0 && since < 1e-7) continue;
    const double expected = path.At("direction")[i] > 0 ? 0.0 : 5e-6 * std::exp(-since / 2e-3);
    // The axis turned within 0.1 um of the end, and what it moved on there is a ramp of 1 ms steps.
    EXPECT_NEAR(x[i], expected, 1e-9) << path.At("x_mm")[i];
  }
}

TEST(HiddenMotion, ALoadLowersTheThirdAxis) {
  const auto path = ThereAndBack(Hide({"load-coupling:object=XY:coefficient_nm_per_mm2=2"}));
  const auto z = Deviations(path, 'z');
  for (std::size_t i = 0; i < z.size(); ++i) {
    EXPECT_NEAR(z[i], -2e-9 * path.At("x_mm")[i] * path.At("y_mm")[i], kRounding);
  }
}

TEST(HiddenMotion, SquarenessTurnsALine) {
  const auto path = ThereAndBack(
      Hide({"squareness:object=XY:angle_urad=100", "squareness:object=XZ:angle_urad=200",
            "squareness:object=YZ:angle_urad=300"}));
  const auto x = Deviations(path, 'x'), y = Deviations(path, 'y');
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double at_y = 1e-3 * path.At("y_mm")[i], at_z = 1e-3 * path.At("z_mm")[i];
    // C0Y turns the way of the table towards -x; B0Z and A0Z turn that of the tool towards +x and
    // -y, which is the other way in the coordinates of the table's axes. Second order: 1e-7 of 60
    // mm.
    EXPECT_NEAR(x[i], -100e-6 * at_y - 200e-6 * at_z, 6e-9);
    EXPECT_NEAR(y[i], 300e-6 * at_z, 6e-9);
  }
}

TEST(HiddenMotion, VibrationIsALineInTime) {
  const auto path = ThereAndBack(Hide({"vibration:object=Z:frequency_hz=5:amplitude_um=0.3"}));
  const auto z = Deviations(path, 'z');
  const auto time = path.At("time_s");
  double most = 0.0, square = 0.0;
  for (std::size_t i = 0; i + 10 < z.size(); ++i) {
    most = std::max(most, std::abs(z[i]));
    square += z[i] * z[i] / static_cast<double>(z.size());
    // Half a period later the other way.
    if (std::abs(time[i + 10] - time[i] - 0.1) < 1e-9) {
      EXPECT_NEAR(z[i + 10], -z[i], 1e-14);
    }
  }
  EXPECT_LE(most, 0.3e-6 + kRounding);
  EXPECT_NEAR(std::sqrt(2.0 * square), 0.3e-6, 0.03e-6);  // a line of some ten periods
}

TEST(HiddenMotion, FeedSquareAndDiagonalRippleAreNoCauses) {
  const auto path = ThereAndBack(
      Hide({"unknown-feed-square:object=X:height_um=4",
            "unknown-diagonal-ripple:object=XY:amplitude_um=3:period_mm=8:phase_rad=0"}));
  const auto x = Deviations(path, 'x'), z = Deviations(path, 'z');
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double sum = path.At("x_mm")[i] + path.At("y_mm")[i];
    EXPECT_NEAR(z[i], 3e-6 * std::sin(2.0 * std::numbers::pi * sum / 8.0), kRounding);
    // At the full feed of 600 mm/min in both directions.
    if (sum > 35.0 && sum < 65.0) {
      EXPECT_NEAR(x[i], 4e-6, 1e-10);
    }
  }
}

}  // namespace hidden_motion_test
}  // namespace abbe::rig
