#include "paths/shaft_readings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace abbe::paths {
namespace shaft_readings_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = M_PI / 180.0;

recording::Recording Turning() {
  recording::Recording recording;
  recording.name = "turn.csv";
  recording.columns = {{"time_s", {0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 5.0}},
                       {"shaft_deg", {kNan, 350.0, kNan, kNan, 10.0, 20.0, kNan}},
                       {"gap_mm", {7.0, kNan, 1.0, 9.0, 2.0, kNan, 8.0}},
                       {"flags", {0, 0, 0, 1, 0, 0, 0}}};
  return recording;
}

// Over the end of the turn, between the angles only, without the flagged row.
TEST(ShaftReadings, InterpolateTheAngleInTime) {
  const ShaftReadings shaft = ReadShaft(Turning(), "shaft_deg", "gap_mm");
  ASSERT_EQ(shaft.value, (std::vector<double>{1e-3, 2e-3}));
  EXPECT_EQ(shaft.time, (std::vector<double>{2.0, 3.0}));
  EXPECT_NEAR(shaft.angle[0], 360.0 * kDegree, 1e-14);
  EXPECT_NEAR(shaft.angle[1], 370.0 * kDegree, 1e-14);
}

TEST(ShaftReadings, RefuseWhatIsNoAngleOrNeverMeets) {
  EXPECT_THROW(ReadShaft(Turning(), "gap_mm", "gap_mm"), InputError);
  EXPECT_THROW(ReadShaft(Turning(), "shaft_deg", "other_mm"), InputError);
  auto apart = Turning();
  apart.columns[2].values = {7.0, kNan, kNan, kNan, kNan, kNan, 8.0};
  EXPECT_THROW(ReadShaft(apart, "shaft_deg", "gap_mm"), InputError);
  apart.columns[1].values.assign(7, kNan);
  EXPECT_THROW(ReadShaft(apart, "shaft_deg", "gap_mm"), InputError);
}

}  // namespace shaft_readings_test
}  // namespace abbe::paths
