// Lengths and plates approached from both sides on a perfect machine whose axes lose motion.
#include <gtest/gtest.h>

#include <cmath>

#include "rig/record_lengths.h"
#include "rig/record_plate.h"
#include "tests/rig/hidden_worlds.h"

namespace abbe::rig {
namespace both_ways_test {

constexpr double kExact = 1e-12, kSolved = 1e-9;  // m

// A place is measured once from below and once from above: all that differs is the lost motion.
TEST(BothWays, LengthsDifferByTheWidthOfThePlayAtThePlace) {
  const double width = 6e-6, change = 4e-6, bow = 3e-6, travel = 60e-3;
  const LinkageRig rig = PerfectLinkageRig(
      Hide({"backlash:object=X:width_um=6", "varying-backlash:object=X:change_um=4:bow_um=3"}));
  const auto lengths = RecordLengths(rig, {.both_ways = true, .u = 0.0, .u_scale = 0.0});
  const auto length = lengths.At("length_mm"), x = lengths.At("x_mm");
  const auto approach = lengths.At("approach_x");
  ASSERT_EQ(lengths.rows(), 25u);
  for (std::size_t row = 1; row <= 12; ++row) {
    const std::size_t back = 25 - row;
    ASSERT_EQ(x[row], x[back]);
    EXPECT_EQ(approach[row], 1.0);
    EXPECT_EQ(approach[back], -1.0);
    const double t = 2.0 * 1e-3 * x[row] / travel - 1.0;
    EXPECT_NEAR(1e-3 * (length[back] - length[row]),
                width + 0.5 * change * t + bow * (t * t - 1.0 / 3.0), kExact)
        << row;
  }
}

TEST(BothWays, HolesShowHalfOfTheWidthToTheSideFromWhichTheyAreApproached) {
  constexpr double kWidth = 4e-6;
  const PlateProgram program{.u_form = 0.0, .u_scale = 0.0, .u_probing = 0.0, .both_sides = true};
  const auto exact = RecordPlate(World(PerfectRig(), 3), program);
  const auto plate =
      RecordPlate(World(PerfectRig(), 3, Hide({"backlash:object=Y:width_um=4"})), program);
  int above = 0;
  for (std::size_t row = 0; row < plate.rows(); ++row) {
    const double side = plate.At("approach_y")[row];
    above += side < 0.0 ? 1 : 0;
    EXPECT_NEAR(1e-3 * (plate.At("y_mm")[row] - exact.At("y_mm")[row]), 0.5 * side * kWidth,
                kSolved);
    EXPECT_EQ(plate.At("x_mm")[row], exact.At("x_mm")[row]);
  }
  EXPECT_EQ(above, 5 * 3 * 7);
}

}  // namespace both_ways_test
}  // namespace abbe::rig
