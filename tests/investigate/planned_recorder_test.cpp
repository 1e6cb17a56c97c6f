// The rig records a planned path: where the axes went, what the header says.
#include "rig/planned_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "simulation/planned_paths.h"
#include "tests/investigate/investigated_world.h"

namespace abbe {
namespace planned_recorder_test {

class PlannedRecorder : public ::testing::Test {
 protected:
  PlannedRecorder() : recorder_(machine_.rig(), 7, {}, kStarted) {}

  simulation::PathAbout About() const {
    return {"demo-mill", kStarted + 600.0, {{"temp_table_c", 20.0}, {"temp_column_c", 20.0}}};
  }
  const std::array<machine::Travel, 3>& Travels() {
    return machine_.subject().instruments.machine.travels;
  }

  InvestigatedMachine machine_;
  rig::PlannedRecorder recorder_;
};

TEST_F(PlannedRecorder, GoesRoundACircle) {
  const auto path = simulation::CirclePath({.centre = {0.03, 0.03, 0.03},
                                            .radius = 0.02,
                                            .feed = 0.01,
                                            .mounting = "base = \"first\"\n"},
                                           About());
  const auto circle = recorder_.Record(path, 1);
  EXPECT_EQ(circle.Kind(), "linkage");
  EXPECT_EQ(circle.HeaderText("mounting.base"), "first");
  EXPECT_EQ(circle.HeaderText("started"), path.HeaderText("started"));
  // Another circle needs no set-up.
  EXPECT_EQ(investigate::PlaceOf(circle), investigate::PlaceOf(path));
  const auto x = circle.At("x_mm"), y = circle.At("y_mm"), pass = circle.At("pass");
  std::set<double> passes(pass.begin(), pass.end());
  EXPECT_THAT(passes, testing::ElementsAre(1.0, 2.0));
  // Chords of 2 degrees lie 3 um inside; the axes lag behind by 15 ms.
  for (std::size_t row = 0; row < x.size(); ++row) {
    EXPECT_NEAR(std::hypot(x[row] - 30.0, y[row] - 30.0), 20.0, 0.005) << row;
  }
  // All the way round: within a tenth of the radius of each quarter.
  for (const auto& [px, py] : {std::pair{50.0, 30.0}, {30.0, 50.0}, {10.0, 30.0}, {30.0, 10.0}}) {
    double nearest = 1e9;
    for (std::size_t row = 0; row < x.size(); ++row) {
      nearest = std::min(nearest, std::hypot(x[row] - px, y[row] - py));
    }
    EXPECT_LT(nearest, 2.0);
  }
}

TEST_F(PlannedRecorder, StandsAtTheStationsOfASweep) {
  const auto path = simulation::SweepPath('Y', Travels(), "id = \"first\"\n", About());
  const auto sweep = recorder_.Record(path, 2);
  const auto planned = path.At("y_mm"), made = sweep.At("y_mm");
  const std::set<double> stations(planned.begin(), planned.end());
  EXPECT_EQ(stations.size(), 16u);
  std::set<double> met;
  for (const double y : made) {
    for (const double station : stations) {
      if (std::abs(y - station) < 0.02) met.insert(station);
    }
  }
  EXPECT_EQ(met, stations);
}

// A recording as a path: its axes were still settling when its rows began.
TEST_F(PlannedRecorder, RepeatsWhatItRecorded) {
  const auto sweep =
      recorder_.Record(simulation::SweepPath('Z', Travels(), "id = \"first\"\n", About()), 1);
  const auto again = recorder_.Record(sweep, 2);
  EXPECT_EQ(again.rows(), sweep.rows());
  const auto one = sweep.At("z_mm"), other = again.At("z_mm");
  for (std::size_t row = 0; row < one.size(); ++row) EXPECT_NEAR(other[row], one[row], 1e-3) << row;

  const auto cube = recorder_.Record(simulation::GridPath({.middle = {0.03, 0.03, 0.03},
                                                           .size = {0.02, 0.02, 0.02},
                                                           .counts = {2, 2, 2},
                                                           .mounting = "base = \"first\"\n"},
                                                          About()),
                                     3);
  EXPECT_EQ(recorder_.Record(cube, 4).rows(), cube.rows());
}

TEST_F(PlannedRecorder, NamesWhatIsMountedAnewByTheRun) {
  const auto path = simulation::SweepPath('X', Travels(), "id = \"planned anew\"\n", About());
  EXPECT_EQ(recorder_.Record(path, 5).HeaderText("mounting.id"), "mounted 5");
  const auto again = simulation::SweepPath('X', Travels(), "id = \"mounted 5\"\n", About());
  EXPECT_EQ(recorder_.Record(again, 9).HeaderText("mounting.id"), "mounted 5");
}

TEST_F(PlannedRecorder, DoesNotRecordSwappedCables) {
  EXPECT_TRUE(recorder_.Records(simulation::SweepPath('X', Travels(), "", About())));
  EXPECT_FALSE(recorder_.Records(
      simulation::SweepPath('X', Travels(), "swapped = \"probe_a+probe_b\"\n", About())));
}

}  // namespace planned_recorder_test
}  // namespace abbe
