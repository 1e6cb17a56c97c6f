#include "rig/truth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "failure/failure.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace truth_test {

using nlohmann::ordered_json;

// A result that holds the truth, with a line added that a sweep cannot see, and `error` at one
// station.
ordered_json ResultOf(const ordered_json& truth, double error) {
  ordered_json result;
  result["axis"] = "X";
  result["stations"] = truth["axes"]["X"]["stations_m"];
  for (const char* name : {"EYX", "EAX"}) {
    std::vector<double> value = truth["axes"]["X"][name];
    for (std::size_t i = 0; i < value.size(); ++i) {
      value[i] += 3e-6 + (name[1] == 'Y' ? 2e-6 * static_cast<double>(i) : 0.0);
    }
    value[7] += error;
    result["errors"][name] = {{"value", value}, {"u", std::vector<double>(value.size(), 1e-7)}};
  }
  return result;
}

TEST(Truth, ListsTheErrorsAtTheStations) {
  const World world(DemoRig(), 9);
  const ordered_json truth = TruthOf(world);
  EXPECT_EQ(truth["machine"], "demo-mill");
  EXPECT_EQ(truth["seed"], 9);
  EXPECT_TRUE(truth["hidden"].empty());
  EXPECT_EQ(truth["axes"]["Z"]["carries"], "head");
  ASSERT_EQ(truth["axes"]["Z"]["stations_m"].size(), 61U);
  EXPECT_EQ(truth["axes"]["Z"]["EBZ"][30].get<double>(), world.ErrorsOf(2, 0.03)[4]);
  EXPECT_EQ(truth["squareness"]["C0Y"].get<double>(), world.squareness().c0y);
  EXPECT_EQ(truth["head"]["probe_e"]["gain"].get<double>(), world.probes()[4].gain);
}

TEST(Truth, ComparesWhatASweepDefines) {
  const ordered_json truth = TruthOf(World(DemoRig(), 9));
  for (const ComponentComparison& component : Compare(truth, ResultOf(truth, 0.0), "r.json")) {
    EXPECT_LT(component.max_error, 1e-18) << component.component;  // rounding of 1e-4
    EXPECT_EQ(component.share_inside_2u, 1.0);
  }
}

TEST(Truth, SeesAnErrorOfOneStation) {
  const ordered_json truth = TruthOf(World(DemoRig(), 9));
  const auto found = Compare(truth, ResultOf(truth, 1e-6), "r.json");
  ASSERT_EQ(found.size(), 2U);
  // An angle keeps it whole: 1 urad at one of 61 stations.
  EXPECT_EQ(found[1].component, "EAX");
  EXPECT_NEAR(found[1].max_error, 1e-6, 1e-18);
  EXPECT_NEAR(found[1].rms_error, 1e-6 / std::sqrt(61.0), 1e-18);
  EXPECT_NEAR(found[1].rms_pull, 10.0 / std::sqrt(61.0), 1e-10);
  EXPECT_NEAR(found[1].share_inside_2u, 60.0 / 61.0, 1e-15);
  // A line takes up the hat of that station: h = 1/n + (i - m)^2 / S, and leaves sqrt(1 - h) in
  // rms.
  const double hat = 1.0 / 61.0 + 23.0 * 23.0 / (61.0 * (61.0 * 61.0 - 1.0) / 12.0);
  EXPECT_NEAR(found[0].max_error, 1e-6 * (1.0 - hat), 1e-15);
  EXPECT_NEAR(found[0].rms_error, 1e-6 * std::sqrt((1.0 - hat) / 61.0), 1e-15);
}

// The first station of an angle has no uncertainty, for it is zero by definition.
TEST(Truth, LeavesOutTheStationThatIsZeroByDefinition) {
  const ordered_json truth = TruthOf(World(DemoRig(), 9));
  ordered_json result = ResultOf(truth, 1e-6);
  result["errors"]["EAX"]["u"][0] = 0.0;
  EXPECT_NEAR(Compare(truth, result, "r.json")[1].rms_pull, 10.0 / std::sqrt(60.0), 1e-10);
  result["errors"]["EAX"]["u"][7] = 0.0;
  EXPECT_TRUE(std::isnan(Compare(truth, result, "r.json")[1].rms_pull));
}

TEST(Truth, RefusesWhatIsNoResult) {
  const ordered_json truth = TruthOf(World(DemoRig(), 9));
  EXPECT_THROW(Compare(truth, ordered_json::object(), "r.json"), InputError);
  ordered_json shifted = ResultOf(truth, 0.0);
  shifted["stations"][60] = 0.09;
  EXPECT_THROW(Compare(truth, shifted, "r.json"), InputError);
  ordered_json ragged = ResultOf(truth, 0.0);
  ragged["errors"]["EYX"]["u"].erase(3);
  EXPECT_THROW(Compare(truth, ragged, "r.json"), InputError);
}

}  // namespace truth_test
}  // namespace abbe::rig
