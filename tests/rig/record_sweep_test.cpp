#include "rig/record_sweep.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rig/motion.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace record_sweep_test {

std::vector<hal::Channel> DemoChannels() {
  return ChannelsOf(hal::ReadDevices(DemoMill().Root().Child("devices")));
}

TEST(Campaign, HasTheColumnsOfARecordedSweep) {
  const World world(DemoRig(), 1);
  const recording::Recording sweep = RecordSweep(world, 'Y', DemoChannels(), {.rate = 10.0});
  std::vector<std::string> names;
  for (const recording::Column& column : sweep.columns) names.push_back(column.name);
  EXPECT_EQ(names, (std::vector<std::string>{"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction",
                                             "feed_mm_min", "probe_a_um", "probe_b_um",
                                             "probe_c_um", "probe_d_um", "probe_e_um",
                                             "temp_column_c", "temp_table_c", "flags"}));
  EXPECT_EQ(sweep.Kind(), "sweep");
  EXPECT_EQ(sweep.HeaderText("axis"), "Y");
  EXPECT_EQ(sweep.HeaderText("machine"), "demo-mill");
}

// At the end of each standstill the rows are the world's readings at the station, with noise.
TEST(Campaign, RowsAreReadingsOfTheWorld) {
  const RigSettings settings = DemoRig();
  const World world(settings, 2);
  const recording::Recording sweep = RecordSweep(world, 'Z', DemoChannels(), {.rate = 20.0});
  const SweepMotion motion(*settings.sweeps[2], {settings.acceleration, settings.lag}, 0.0);
  const auto time = sweep.At("time_s"), z = sweep.At("z_mm"), gap = sweep.At("probe_d_um");
  double square = 0.0;
  int rows = 0;
  for (std::size_t row = 0; row < sweep.rows(); ++row) {
    const MotionState state = motion.At(time[row]);
    EXPECT_EQ(sweep.At("pass")[row], state.pass);
    EXPECT_EQ(sweep.At("direction")[row], state.direction);
    EXPECT_NEAR(z[row], 1e3 * state.position, 1e-9);
    EXPECT_EQ(sweep.At("flags")[row], 0.0);
    if (state.station < 0) continue;
    const double noise = 1e-6 * gap[row] - world.ReadingsAt(2, {0.0, 0.0, state.position})[3];
    square += noise * noise;
    ++rows;
  }
  ASSERT_GT(rows, 9000);
  // White noise of 20 nm and one path of a drift of 30 nm, which may be anywhere within 3.5 of
  // them.
  EXPECT_GT(std::sqrt(square / rows), 20e-9 * 0.97);
  EXPECT_LT(std::sqrt(square / rows), std::hypot(20e-9, 3.5 * 30e-9));
}

TEST(Campaign, WithoutNoiseReadsTheWorldExactly) {
  RigSettings settings = DemoRig();
  settings.white = settings.drift = 0.0;
  const World world(settings, 2);
  const recording::Recording sweep = RecordSweep(world, 'X', DemoChannels(), {.rate = 37.0});
  for (std::size_t row = 0; row < sweep.rows(); row += 11) {
    const Readings gaps = world.ReadingsAt(0, {1e-3 * sweep.At("x_mm")[row], 0.0, 0.0});
    // The header's promise for the nanometre that is not looked at again.
    EXPECT_NEAR(1e-6 * sweep.At("probe_a_um")[row], gaps[0], 1e-12);
    EXPECT_NEAR(1e-6 * sweep.At("probe_e_um")[row], gaps[4], 1e-12);
  }
}

TEST(Campaign, IsAFunctionOfSeedAndRun) {
  const World world(DemoRig(), 3), same(DemoRig(), 3), other(DemoRig(), 4);
  const auto gaps = [](const World& of, std::uint64_t run) {
    return RecordSweep(of, 'X', DemoChannels(), {.rate = 5.0, .run = run}).At("probe_a_um")[100];
  };
  EXPECT_EQ(gaps(world, 1), gaps(same, 1));
  EXPECT_NE(gaps(world, 1), gaps(world, 2));
  EXPECT_NEAR(gaps(world, 1), gaps(world, 2), 0.4);  // the noise alone: eight of its deviations
  EXPECT_GT(std::abs(gaps(world, 1) - gaps(other, 1)), 0.4);
}

TEST(Campaign, CanLeaveOutTheMotion) {
  const World world(DemoRig(), 3);
  const recording::Recording all = RecordSweep(world, 'X', DemoChannels(), {.rate = 100.0});
  const recording::Recording still =
      RecordSweep(world, 'X', DemoChannels(), {.rate = 100.0, .moving = false});
  EXPECT_LT(still.rows(), all.rows());
  // 610 standstills of at least settle + dwell.
  EXPECT_GE(still.rows(), 610U * 60U);
}

TEST(Campaign, MarksGapsOutOfRange) {
  RigSettings settings = DemoRig();
  settings.probe_position = 120e-6;
  const World world(settings, 7);
  const recording::Recording sweep = RecordSweep(world, 'X', DemoChannels(), {.rate = 5.0});
  bool any = false;
  for (std::size_t probe = 7; probe < 12; ++probe)
    any |= std::isnan(sweep.columns[probe].values[0]);
  EXPECT_TRUE(any);
  EXPECT_EQ(sweep.At("flags")[0], recording::kOutOfRange);
}

TEST(Campaign, RefusesWhatTheRigCannotDo) {
  RigSettings settings = DemoRig();
  settings.sweeps[1].reset();
  const World world(settings, 1);
  EXPECT_THROW(RecordSweep(world, 'Y', DemoChannels()), InputError);
  EXPECT_THROW(RecordSweep(world, 'A', DemoChannels()), InputError);
  EXPECT_THROW(RecordSweep(world, 'X', DemoChannels(), {.rate = 2000.0}), InputError);
  EXPECT_THROW(RecordSweep(world, 'X', {{"force_n", "cap"}}), InputError);
}

}  // namespace record_sweep_test
}  // namespace abbe::rig
