// A recorded run made again, by hand on four rows.
#include "simulation/repeated_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "simulation/kinds.h"
#include "tests/diagnosis/planned_circles.h"

namespace abbe::simulation {
namespace repeated_run_test {

using testing::ElementsAre;

recording::Recording FourRows() {
  recording::Recording run;
  run.header =
      "kind = \"sweep\"\naxis = \"X\"\n[sweep]\nsettle_s = 0.2\n[mounting]\nid = \"a \\\"b\\\"\"\n";
  run.columns = {{"time_s", {1.0, 2.0, 5.0, 6.0}},      {"x_mm", {0.0, 1.0, 1.0, 0.0}},
                 {"y_mm", {0.0, 0.0, 0.0, 0.0}},        {"z_mm", {0.0, 0.0, 0.0, 0.0}},
                 {"pass", {1.0, 1.0, 2.0, 2.0}},        {"direction", {1.0, 1.0, -1.0, -1.0}},
                 {"feed_mm_min", {600, 600, 600, 600}}, {"temp_table_c", {20, 20, 20, 21}}};
  return run;
}

std::vector<double> In(const recording::Recording& run, const char* column) {
  const auto values = run.At(column);
  return {values.begin(), values.end()};
}

TEST(RepeatedRun, TurnedRoundItGoesBackOnItsWay) {
  const auto back = TurnedRound(FourRows());
  EXPECT_THAT(In(back, "time_s"), ElementsAre(0.0, 1.0, 4.0, 5.0));
  EXPECT_THAT(In(back, "x_mm"), ElementsAre(0.0, 1.0, 1.0, 0.0));
  EXPECT_THAT(In(back, "pass"), ElementsAre(1.0, 1.0, 2.0, 2.0));
  EXPECT_THAT(In(back, "direction"), ElementsAre(1.0, 1.0, -1.0, -1.0));
  EXPECT_THAT(In(back, "temp_table_c"), ElementsAre(21.0, 20.0, 20.0, 20.0));
}

TEST(RepeatedRun, AtAFifthOfItsFeedItTakesFiveTimesAsLong) {
  const auto slow = AtFeed(FourRows(), 0.2);
  EXPECT_THAT(In(slow, "time_s"), ElementsAre(5.0, 10.0, 25.0, 30.0));
  EXPECT_DOUBLE_EQ(In(slow, "feed_mm_min")[0], 120.0);
}

TEST(RepeatedRun, KeepsWhatASimulationAsksFor) {
  const auto again = Again(FourRows(), {"mill \"1\"", 1'795'248'000.0, "id = \"anew\"\n"});
  EXPECT_EQ(again.Kind(), "sweep");
  EXPECT_EQ(again.HeaderText("machine"), "mill \"1\"");
  EXPECT_EQ(again.HeaderText("axis"), "X");
  EXPECT_EQ(again.HeaderText("started"), "2026-11-21T08:00:00Z");
  EXPECT_EQ(again.HeaderNumber("sweep.settle_s"), 0.2);
  EXPECT_EQ(again.HeaderText("mounting.id"), "anew");
}

// The run of a kind that says "in the reverse order", "at a fifth of its feed" and the like.
recording::Recording Repeated(const RunKind& kind, const recording::Recording& run,
                              const std::string& how) {
  for (const NextRun& next : kind.NextRuns({&run}, diagnosis::DemoInstruments(), {})) {
    if (next.text.find(how) != std::string::npos) return next.path;
  }
  return {};
}

TEST(RepeatedRun, StaysMountedAsItWas) {
  EXPECT_EQ(Repeated(SweepKind(), FourRows(), "reverse order").HeaderText("mounting.id"),
            "a \"b\"");
  auto circle = diagnosis::CircleAt(600.0);
  circle.header += "[mounting]\nbase = \"b 2\"\n";
  EXPECT_EQ(Repeated(LinkageKind(), circle, "reverse order").HeaderText("mounting.base"), "b 2");
  EXPECT_EQ(Repeated(LinkageKind(), circle, "set it up anew").HeaderText("mounting.base"),
            "planned anew");
}

TEST(RepeatedRun, WarmerIsEverySensor) {
  EXPECT_THAT(In(Warmer(FourRows(), 3.0), "temp_table_c"), ElementsAre(23.0, 23.0, 23.0, 24.0));
}

TEST(PlannedRun, RowsWithoutAPlaceDoNotCount) {
  auto run = diagnosis::CircleAt(600.0);
  run.columns[1].values[3] = std::nan("");
  const auto planned = Planned(run, diagnosis::DemoInstruments());
  EXPECT_EQ(planned.At("flags")[2], 0.0);
  EXPECT_NE(planned.At("flags")[3], 0.0);
  EXPECT_EQ(planned.At("pivot_1_rad")[3], 0.0);
  EXPECT_NE(planned.At("pivot_1_rad")[4], 0.0);
}

}  // namespace repeated_run_test
}  // namespace abbe::simulation
