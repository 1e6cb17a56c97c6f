#include "hal/sweep_plan.h"

#include <gtest/gtest.h>

#include <string>

#include "../folders.h"

namespace abbe::hal {
namespace sweep_plan_test {

SweepPlan Plan(const std::string& text, char axis = 'X') {
  return ReadSweepPlan(settings::Document::Parse(text, "m.toml").Root().Child("sweep"), axis);
}

std::string Refusal(const std::string& text) {
  try {
    Plan(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SweepPlan, ReadsTheDemonstrationMachine) {
  const auto file = settings::Document::Read(DemoMillFile());
  for (const char axis : {'X', 'Y', 'Z'}) {
    const SweepPlan plan = ReadSweepPlan(file.Root().Child("sweep"), axis);
    ASSERT_EQ(plan.stations.size(), 61u);
    EXPECT_EQ(plan.first(), 0.0);
    EXPECT_DOUBLE_EQ(plan.last(), 0.06);
    EXPECT_DOUBLE_EQ(plan.stations[17], 0.017);
    EXPECT_EQ(plan.passes, 5);
    EXPECT_DOUBLE_EQ(plan.window, 20e-6);
    EXPECT_DOUBLE_EQ(plan.feed, 0.01);
    EXPECT_EQ(plan.Visits().size(), 610u);
  }
}

TEST(SweepPlan, VisitsEveryStationFromBothSidesInEachPass) {
  const SweepPlan plan = Plan("[sweep]\npasses = 2\n[sweep.X]\nstations_mm = [0, 10, 25]");
  std::string order;
  for (const Visit& visit : plan.Visits()) {
    order += std::to_string(visit.pass) + (visit.direction > 0 ? "+" : "-") +
             std::to_string(visit.station) + " ";
  }
  EXPECT_EQ(order, "1+0 1+1 1+2 1-2 1-1 1-0 2+0 2+1 2+2 2-2 2-1 2-0 ");
}

TEST(SweepPlan, RefusesWithLineKeyAndRemedy) {
  EXPECT_EQ(Refusal("[sweep]\npases = 2\n[sweep.X]\nstations_mm = [0, 1]"),
            "m.toml:2: sweep.pases: is not a known key; did you mean \"passes\"?");
  EXPECT_EQ(Refusal("[sweep.X]\nstations_mm = [0, 1]\nstation_mm = 1"),
            "m.toml:3: sweep.X.station_mm: is not a known key; did you mean \"stations_mm\"?");
  EXPECT_EQ(
      Refusal("[sweep.X]\nfirst_mm = 0\nlast_mm = 10\nstep_mm = 3"),
      "m.toml:4: sweep.X.step_mm: does not divide the length of 10 mm into whole steps; change "
      "it or list the stations in stations_mm");
  EXPECT_EQ(Refusal("[sweep.X]\nstations_mm = [0, 1]\nstep_mm = 1"),
            "m.toml:3: sweep.X.step_mm: is given together with stations_mm; keep one of the two");
  EXPECT_EQ(
      Refusal("[sweep.X]\nfirst_mm = 10\nlast_mm = 0\nstep_mm = 1"),
      "m.toml:3: sweep.X.last_mm: must be greater than first_mm; a sweep goes both ways anyway");
  EXPECT_EQ(
      Refusal("[sweep.X]\nstations_mm = [0, 1, 0.5]"),
      "m.toml:2: sweep.X.stations_mm: station 3 must lie at least four windows (0.08 mm) above "
      "the one before it");
  EXPECT_EQ(Refusal("[sweep]\noverrun_mm = 0.01\n[sweep.X]\nstations_mm = [0, 1]"),
            "m.toml:2: sweep.overrun_mm: must be at least four windows (0.08 mm)");
  EXPECT_EQ(
      Refusal("[sweep]\npasses = 1000\n[sweep.X]\nfirst_mm = 0\nlast_mm = 100\nstep_mm = 0.1"),
      "m.toml:2: sweep.passes: 1000 over 1001 stations are more than a sweep takes (1e+06 "
      "visits); give fewer");
  EXPECT_EQ(Refusal("[sweep.Y]\nstations_mm = [0, 1]"),
            "m.toml: sweep.X.first_mm: is missing; it must be a number");
}

}  // namespace sweep_plan_test
}  // namespace abbe::hal
