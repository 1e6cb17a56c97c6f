#include "rig/record_plate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace record_plate_test {

using Eigen::Vector3d;

constexpr double kMillimetre = 1e-3;

Vector3d Row(const recording::Recording& recording, std::size_t row) {
  return kMillimetre *
         Vector3d(recording.At("x_mm")[row], recording.At("y_mm")[row], recording.At("z_mm")[row]);
}

PlateProgram Exact() { return {.u_form = 0.0, .u_scale = 0.0, .u_probing = 0.0}; }

// On a perfect machine the axes are as far apart as the holes, but for how deep the probe stands:
// (20 um)^2 / 9 mm / 2 = 0.02 um at most.
TEST(PlateCampaign, APerfectMachineShowsTheCertificate) {
  const auto plate = RecordPlate(World(PerfectRig(), 3), Exact());
  ASSERT_EQ(plate.rows(), 5u * 49u);
  for (std::size_t row = 1; row < plate.rows(); ++row) {
    if (plate.At("setup")[row] != plate.At("setup")[row - 1]) continue;
    const double apart =
        kMillimetre * std::hypot(plate.At("plate_x_mm")[row] - plate.At("plate_x_mm")[row - 1],
                                 plate.At("plate_y_mm")[row] - plate.At("plate_y_mm")[row - 1]);
    EXPECT_NEAR((Row(plate, row) - Row(plate, row - 1)).norm(), apart, 1e-7) << row;
  }
}

// A scale error of X alone: the plate in XY looks longer along x, by what the axis lacks.
TEST(PlateCampaign, AScaleErrorOfAnAxisShowsInItsDirection) {
  RigSettings machine = PerfectRig();
  machine.population.scale = 1e-3;
  const World world(machine, 2);
  const auto plate = RecordPlate(world, Exact());
  const double side = kMillimetre * plate.At("plate_x_mm")[6];
  const double seen = std::abs(Row(plate, 6).x() - Row(plate, 0).x());
  // The plate lies 1 mrad askew: 0.5 ppm for each turn.
  EXPECT_NEAR(seen, side / (1.0 + world.ScaleOf(0)), 5e-6 * side);
  EXPECT_GT(std::abs(world.ScaleOf(0)), 1e-4);
}

// The form belongs to the plate: with nothing else wrong, two set-ups in two runs show the same.
TEST(PlateCampaign, TheFormIsTheSameInEverySetupAndRun) {
  const World world(PerfectRig(), 4);
  PlateProgram program = Exact();
  program.u_form = 100e-6;
  const auto one = RecordPlate(world, program);
  program.run = 2;
  const auto other = RecordPlate(world, program);
  double largest = 0.0;
  for (std::size_t row = 1; row < 49; ++row) {
    const double first = (Row(one, row) - Row(one, 0)).norm();
    const double again = (Row(other, 49 + row) - Row(other, 49)).norm();
    EXPECT_NEAR(first, again, 1e-7);
    const double nominal =
        kMillimetre * std::hypot(one.At("plate_x_mm")[row], one.At("plate_y_mm")[row]);
    largest = std::max(largest, std::abs(first - nominal));
  }
  EXPECT_GT(largest, 100e-6);
  EXPECT_NE(one.At("x_mm")[0], other.At("x_mm")[0]);  // put down anew
}

}  // namespace record_plate_test
}  // namespace abbe::rig
