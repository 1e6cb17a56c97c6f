#include "apps/reduce_sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "probes/sweep_reduction.h"
#include "tests/probes/synthetic_sweep.h"

namespace abbe::apps {
namespace reduce_sweep_test {

using nlohmann::ordered_json;

probes::SweepResult ResultOf(const probes::SyntheticSweep& sweep) {
  const probes::SweepSetup setup = probes::TestSetup();
  return probes::ReduceSweep(probes::Record(sweep, setup), setup);
}

// The keys that the report and the rig's comparison read.
TEST(ReduceSweep, TheDataHasTheKeysThatOthersRead) {
  const probes::SyntheticSweep sweep{.white = 20e-9, .header = "started = \"2026-11-21\"\n"};
  const ordered_json data = SweepJson(ResultOf(sweep));
  EXPECT_EQ(data.at("command"), "reduce");
  EXPECT_EQ(data.at("kind"), "sweep");
  EXPECT_EQ(data.at("recording"), "synthetic_X.csv");
  EXPECT_EQ(data.at("machine"), "test-mill");
  EXPECT_EQ(data.at("chain"), "[w X Y b Z t]");
  EXPECT_EQ(data.at("axis"), "X");
  EXPECT_EQ(data.at("moves"), "target");
  EXPECT_EQ(data.at("started"), "2026-11-21");
  EXPECT_NEAR(data.at("conditions").at("temp_column_c").at("min"), 20.0, 1e-9);
  EXPECT_NEAR(data.at("conditions").at("feed_mm_min"), 600.0, 1e-9);
  EXPECT_EQ(data.at("stations").size(), 13U);
  EXPECT_EQ(data.at("passes"), 5);
  for (const char* key : {"rows", "used", "flagged", "moving", "outliers"}) {
    EXPECT_TRUE(data.at("samples").at(key).is_number_unsigned()) << key;
  }
  for (const char* name : {"EAX", "EBX", "ECX", "EYX", "EZX"}) {
    const ordered_json& error = data.at("errors").at(name);
    EXPECT_EQ(error.at("unit"), name[1] < 'D' ? "rad" : "m");
    for (const char* key : {"value", "u", "forward", "backward"}) {
      EXPECT_EQ(error.at(key).size(), 13U) << name << " " << key;
    }
    EXPECT_EQ(data.at("errors_at_target").at(name).at("value").size(), 13U);
    EXPECT_EQ(data.at("reversal").at(name).at("value").size(), 13U);
    for (const char* key : {"mean", "max"}) {
      EXPECT_GT(data.at("reversal").at(name).at(key).at("u"), 0.0) << key;
    }
    double variance = 0.0;
    for (const auto& [source, u] : data.at("budget").at(name).items()) {
      variance += u.get<double>() * u.get<double>();
    }
    double stated = 0.0;
    for (const double u : error.at("u")) stated += u * u / 13.0;
    EXPECT_NEAR(variance / stated, 1.0, 1e-9) << name;  // the sources add up
  }
  EXPECT_EQ(data.at("errors").at("EAX").at("kind"), "roll");
  EXPECT_EQ(data.at("errors").at("EYX").at("kind"), "straightness");
  EXPECT_EQ(data.at("angular_ranges").size(), 3U);
  EXPECT_EQ(data.at("straightness").size(), 2U);
  for (const char* probe : {"probe_a", "probe_b", "probe_c", "probe_d", "probe_e"}) {
    EXPECT_EQ(data.at("residuals").at(probe).size(), 130U);
    EXPECT_NEAR(data.at("noise").at(probe).at("white_m").get<double>(), 20e-9, 1e-9);
  }
  for (const char* key : {"time_s", "station", "direction", "pass"}) {
    EXPECT_EQ(data.at("dwells").at(key).size(), 130U) << key;
  }
}

// The lines go with the values: about each of them the values leave the stated error.
TEST(ReduceSweep, TheLinesLieThroughTheValues) {
  const ordered_json data = SweepJson(ResultOf({.tilt_s = 1e-4, .tilt_n = 1e-4}));
  for (const char* line : {"end_points", "least_squares", "minimum_zone"}) {
    const ordered_json& through = data.at("straightness_lines").at("EYX").at(line);
    double most = 0.0, least = 0.0;
    for (std::size_t i = 0; i < 13; ++i) {
      const double at = data.at("stations").at(i);
      const double deviation = data.at("errors").at("EYX").at("value").at(i).get<double>() -
                               through.at("offset").get<double>() -
                               through.at("slope").get<double>() * at;
      most = std::max(most, deviation);
      least = std::min(least, deviation);
    }
    EXPECT_NEAR(data.at("straightness").at("EYX").at(line), most - least, 1e-15) << line;
  }
}

TEST(ReduceSweep, TheTableNamesEverythingInPlainWords) {
  const std::string table = SweepTable(ResultOf({.passes = 1, .backward = false, .white = 20e-9}));
  for (const char* word : {"EAX roll", "EBX pitch", "ECX yaw", "EYX", "EZX", "U95", "minimum zone",
                           "13 stations", "note: one pass", "rows: "}) {
    EXPECT_THAT(table, testing::HasSubstr(word));
  }
}

}  // namespace reduce_sweep_test
}  // namespace abbe::apps
