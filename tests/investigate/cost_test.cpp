// What runs cost, by the table [investigate].
#include "investigate/cost.h"

#include <gtest/gtest.h>

#include "../folders.h"
#include "failure/failure.h"
#include "simulation/planned_paths.h"

namespace abbe {
namespace cost_test {

using investigate::Costs;
using investigate::Place;

simulation::Instruments OnlyLinkage() {
  simulation::Instruments on{};
  const auto demo = settings::Document::Read(DemoMillFile());
  on.linkage = relm::ReadLinkageSettings(demo.Root());
  return on;
}

Costs CostsOf(const std::string& text) {
  const auto document = settings::Document::Parse(text, "mill.toml");
  const Costs costs = investigate::ReadCosts(document.Root(), OnlyLinkage());
  document.Root().RefuseUnknown();
  return costs;
}

const char* const kTable =
    "[investigate]\nat_hand = [\"linkage\", \"length\"]\nrun_min = 2\n"
    "[investigate.linkage]\nset_up_min = 12\nagain_min = 3\n";

// Twice round 20 pi mm at 600 mm/min, less the last row of 180, with a turn of 5 s.
constexpr double kCircleMinutes = (2 * 62.8318530718 / 600) * (1 - 0.5 / 180) + 5.0 / 60;

recording::Recording Circle(const std::string& base) {
  return simulation::CirclePath({.centre = {0.03, 0.03, 0.03},
                                 .radius = 0.01,
                                 .feed = 0.01,
                                 .mounting = "base = \"" + base + "\"\n"},
                                {"mill", 1e9});
}

TEST(Cost, CountsSetUpWaitingAndRun) {
  const Costs costs = CostsOf(kTable);
  const auto circle = Circle("first");
  const auto fresh = CostOf(circle, {}, 0.0, costs);
  EXPECT_DOUBLE_EQ(fresh.set_up, 12.0);
  EXPECT_NEAR(fresh.run, 2.0 + kCircleMinutes, 1e-6);
  EXPECT_DOUBLE_EQ(fresh.total(), fresh.set_up + fresh.run);
  const Place mounted = investigate::PlaceOf(circle);
  EXPECT_DOUBLE_EQ(CostOf(circle, mounted, 0.0, costs).set_up, 0.0);
  EXPECT_DOUBLE_EQ(CostOf(Circle("anew"), mounted, 0.0, costs).set_up, 3.0);
  EXPECT_DOUBLE_EQ(CostOf(circle, {"head", "X first"}, 3600.0, costs).set_up, 12.0);
  EXPECT_DOUBLE_EQ(CostOf(circle, mounted, 3600.0, costs).waiting, 60.0);
}

TEST(Cost, TakesWhatTheFileDescribesWithoutAList) {
  EXPECT_TRUE(CostsOf("").at_hand.contains("linkage"));
  EXPECT_EQ(CostsOf("").at_hand.size(), 1u);
  EXPECT_EQ(CostsOf(kTable).at_hand.size(), 2u);
}

TEST(Cost, RefusesAnUnknownInstrumentWithItsLine) {
  try {
    CostsOf("[investigate]\nat_hand = [\"laser\"]\n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("mill.toml:2: investigate.at_hand: \"laser\""),
              std::string::npos)
        << error.what();
  }
}

}  // namespace cost_test
}  // namespace abbe
