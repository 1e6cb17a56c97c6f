#include "rig/effect_comparison.h"

#include <gtest/gtest.h>

#include "failure/failure.h"

namespace abbe::rig {
namespace effect_comparison_test {

using nlohmann::ordered_json;

const ordered_json kTruth = ordered_json::parse(R"({"seed": 7, "hidden": [
  {"cause": "backlash", "object": "X", "parameters": {"width_um": 6.0}},
  {"cause": "thermal-growth", "object": "Y",
   "parameters": {"coefficient_ppm_per_c": 4.0, "sensor": "temp_table_c"}}]})");

TEST(CompareFindings, TellsWhatWasFoundWhatWasNotAndWhatIsWrong) {
  const auto diagnosis = ordered_json::parse(R"({"findings": [
    {"cause": "thermal-growth", "object": "Y", "probability": 0.75, "parameters": [
      {"name": "coefficient_ppm_per_c", "value": 4.5, "unit": "ppm_per_c", "u95": 0.6},
      {"name": "sensor", "value": "temp_table_c"}]},
    {"cause": "servo-lag", "object": "X", "probability": 0.9, "parameters": []}]})");

  const FindingsComparison comparison = CompareFindings(kTruth, diagnosis, "d.json");

  ASSERT_EQ(comparison.hidden.size(), 2U);
  EXPECT_EQ(comparison.hidden[0].name, "backlash:X");
  EXPECT_EQ(comparison.hidden[0].probability, 0.0);
  EXPECT_EQ(comparison.hidden[1].probability, 0.75);
  ASSERT_EQ(comparison.hidden[1].keys.size(), 1U);
  EXPECT_EQ(comparison.hidden[1].keys[0].name, "coefficient_ppm_per_c");
  EXPECT_EQ(comparison.hidden[1].keys[0].truth, 4.0);
  EXPECT_EQ(comparison.hidden[1].keys[0].found, 4.5);
  EXPECT_EQ(comparison.hidden[1].keys[0].u95, 0.6);
  EXPECT_EQ(comparison.wrong, std::vector<std::string>{"servo-lag:X"});
}

TEST(CompareFindings, TakesAPhaseWithinHalfATurn) {
  const auto truth = ordered_json::parse(R"({"hidden": [
    {"cause": "leadscrew-cyclic", "object": "X", "parameters": {"phase_rad": 6.2}}]})");
  const auto diagnosis = ordered_json::parse(R"({"findings": [
    {"cause": "leadscrew-cyclic", "object": "X", "probability": 1.0, "parameters": [
      {"name": "phase_rad", "value": -0.1, "unit": "rad", "u95": 0.05}]}]})");

  const auto comparison = CompareFindings(truth, diagnosis, "d.json");

  EXPECT_NEAR(comparison.hidden.at(0).keys.at(0).found, 6.283185307 - 0.1, 1e-9);
}

TEST(CompareFindings, RefusesWhatIsNoDiagnosis) {
  try {
    CompareFindings(kTruth, ordered_json::object(), "sweep_X.json");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("sweep_X.json: is not a diagnosis"),
              std::string::npos);
  }
}

}  // namespace effect_comparison_test
}  // namespace abbe::rig
