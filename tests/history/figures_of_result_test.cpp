#include "history/figures_of_result.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace abbe::history {
namespace figures_of_result_test {

using Json = nlohmann::ordered_json;

constexpr double kRounding = 1e-12;

const Figure* Find(const Extract& extract, const std::string& name,
                   const std::string& conditions = "") {
  const auto figure = std::ranges::find_if(extract.figures, [&](const Figure& each) {
    return each.Name() == name && (conditions.empty() || each.conditions == conditions);
  });
  return figure == extract.figures.end() ? nullptr : &*figure;
}

// A figure that must be there.
Figure At(const Extract& extract, const std::string& name, const std::string& conditions = "") {
  const Figure* figure = Find(extract, name, conditions);
  if (figure == nullptr) ADD_FAILURE() << name << " is missing";
  return figure == nullptr ? Figure{} : *figure;
}

TEST(FiguresOfResult, OfASweep) {
  const Extract extract = FiguresOf(Json::parse(R"({
    "command": "reduce", "kind": "sweep", "stations": [0.0, 0.01, 0.02],
    "errors": {"EYX": {"unit": "m", "coverage": 2.5, "value": [0, 1e-6, null],
                       "u": [1e-7, 1e-7, 1e-7]},
               "EAX": {"unit": "rad", "value": [0, 2e-6, 4e-6], "u": [1e-6, 1e-6, 1e-6]}},
    "straightness": {"EYX": {"end_points": 3e-6, "least_squares": 2e-6, "minimum_zone": 1.5e-6,
                             "u": 1e-7}},
    "angular_ranges": {"EAX": {"value": 4e-6, "u": 5e-7}},
    "reversal": {"EYX": {"mean": {"value": -3e-7, "u": 1e-7}}},
    "budget": {"EYX": {"noise": 3e-7, "gain": 4e-7, "position": 0, "installation": [1e-7, 3e-7],
                       "form": 2e-7}}})"));
  const Figure straightness = At(extract, "EYX.straightness_um");
  EXPECT_NEAR(straightness.value, 1.5, kRounding);
  EXPECT_NEAR(straightness.U95(), 2.5 * 0.1, kRounding);
  EXPECT_NEAR(At(extract, "EYX.straightness_ls_um").value, 2.0, kRounding);
  EXPECT_NEAR(At(extract, "EYX.straightness_ends_um").value, 3.0, kRounding);
  EXPECT_NEAR(At(extract, "EYX.reversal_um").value, -0.3, kRounding);
  EXPECT_NEAR(At(extract, "EAX.range_urad").value, 4.0, kRounding);
  // Variances 9, 16, (1 + 9) / 2 = 5 and 4 of 34.
  EXPECT_NEAR(straightness.shares.at("head"), 16.0 / 34.0, kRounding);
  EXPECT_NEAR(straightness.shares.at("mounting"), 5.0 / 34.0, kRounding);
  EXPECT_NEAR(straightness.shares.at("target"), 4.0 / 34.0, kRounding);
  EXPECT_TRUE(At(extract, "EAX.range_urad").shares.empty());
  ASSERT_EQ(extract.curves.size(), 2U);
  EXPECT_NEAR(extract.curves[0].positions_mm[1], 10.0, kRounding);
  EXPECT_NEAR(extract.curves[0].value[1], 1.0, kRounding);
  EXPECT_TRUE(std::isnan(extract.curves[0].value[2]));
}

TEST(FiguresOfResult, OfSquareness) {
  const Extract extract = FiguresOf(Json::parse(R"({"command": "reduce", "kind": "squareness",
    "name": "C0Y", "value": -3e-5, "u": 5e-6, "u_slopes": 4e-6, "u_target": 3e-6})"));
  EXPECT_NEAR(At(extract, "C0Y.urad").value, -30.0, kRounding);
  EXPECT_NEAR(At(extract, "C0Y.urad").shares.at("target"), 9.0 / 25.0, kRounding);
  EXPECT_TRUE(IsSigned("urad"));
}

TEST(FiguresOfResult, OfCirclesByPlaneAndConditions) {
  const Extract extract = FiguresOf(Json::parse(R"({"command": "circle", "circles": [
    {"instrument": "linkage", "plane": "XY", "radius_mm": 20.0, "runs": [
      {"feed_mm_min": 300.0, "G_ccw_um": 3.0, "G_cw_um": 3.5, "G_b_um": 4.0, "F_max_um": 2.0,
       "D_um": -0.5, "u": {"G_b_um": 0.5}, "u_calibration": {"G_b_um": 0.4}},
      {"feed_mm_min": 2000.4, "G_cw_um": 9.0}]},
    {"instrument": "reference", "plane": "XY", "radius_mm": 20.0, "runs": [
      {"feed_mm_min": 300.0, "G_b_um": 4.1}]}]})"));
  const Figure slow = At(extract, "XY.circularity_um", "linkage, R 20 mm, F 300");
  EXPECT_EQ(slow.value, 4.0);
  EXPECT_NEAR(slow.shares.at("linkage"), 0.64, kRounding);
  // One sense only: its G.
  EXPECT_EQ(At(extract, "XY.circularity_um", "linkage, R 20 mm, F 2000").value, 9.0);
  EXPECT_EQ(At(extract, "XY.circularity_um", "reference, R 20 mm, F 300").value, 4.1);
  EXPECT_EQ(At(extract, "XY.G_ccw_um").value, 3.0);
  EXPECT_EQ(Find(extract, "XY.G_cw_um", "linkage, R 20 mm, F 2000"), nullptr);
  EXPECT_EQ(At(extract, "XY.D_um").value, -0.5);
  EXPECT_EQ(At(extract, "XY.F_max_um").value, 2.0);
}

TEST(FiguresOfResult, OfPositioning) {
  const Extract extract = FiguresOf(Json::parse(R"({"command": "reduce", "kind": "reference",
    "axis": "X", "iso230_2": {"A_um": 8, "R_um": 3, "E_um": 6, "M_um": 5, "B_um": 2,
    "mean_reversal_um": -1.5, "targets": [{"target_mm": 0, "mean_um": 0.5},
                                          {"target_mm": 100, "mean_um": -0.5}]}})"));
  EXPECT_EQ(At(extract, "X.positioning_A_um").value, 8.0);
  EXPECT_EQ(At(extract, "X.positioning_B_um").value, 2.0);
  EXPECT_EQ(At(extract, "X.positioning_reversal_um").value, -1.5);
  EXPECT_FALSE(At(extract, "X.positioning_A_um").u);
  ASSERT_EQ(extract.curves.size(), 1U);
  EXPECT_EQ(extract.curves[0].value[1], -0.5);
}

TEST(FiguresOfResult, OfAMap) {
  const Extract extract = FiguresOf(Json::parse(R"({"command": "fuse",
    "scale": {"value_ppm": 4.0, "u_ppm": 1.0},
    "parameters": [{"name": "length_scale line.csv.scale", "unit": "ppm", "prior": 0.8}],
    "map": {"grid": {"x": [0, 0.1], "y": [0], "z": [0],
                     "error": [[0, 3e-6], [0, 4e-6], [0, 0]],
                     "u": [[1e-7, 1e-7], [1e-7, 2e-7], [1e-7, 9e-7]]},
            "errors": {"EXX": {"unit": "m", "positions": [0, 0.05, 0.1], "value": [0, 1e-6, -2e-6],
                               "u": [1e-7, 2e-7, 3e-7]},
                       "EYX": {"unit": "m", "positions": [0, 0.05, 0.1], "value": [0, 2e-6, 0],
                               "u": [1e-7, 2e-7, 3e-7]},
                       "C0Y": {"unit": "rad", "value": 2e-5, "u": 1e-6}}}})"));
  EXPECT_NEAR(At(extract, "volumetric_um").value, 5.0, kRounding);
  EXPECT_NEAR(*At(extract, "volumetric_um").u, (3 * 0.1 + 4 * 0.2) / 5, kRounding);
  EXPECT_EQ(At(extract, "scale_ppm").value, 4.0);
  EXPECT_NEAR(At(extract, "scale_ppm").shares.at("length"), 0.64, kRounding);
  EXPECT_NEAR(At(extract, "EXX.range_um").value, 3.0, kRounding);
  EXPECT_NEAR(*At(extract, "EXX.range_um").u, 0.5, kRounding);
  // A triangle of 2 um lies within a zone of 2 um parallel to its base.
  EXPECT_NEAR(At(extract, "EYX.straightness_um").value, 2.0, 1e-9);
  EXPECT_NEAR(*At(extract, "EYX.straightness_um").u, 0.6, kRounding);
  EXPECT_EQ(Find(extract, "EXX.straightness_um"), nullptr);
  EXPECT_NEAR(At(extract, "C0Y.urad").value, 20.0, kRounding);
}

TEST(FiguresOfResult, OfCalibrationAndDiagnosis) {
  const Extract linkage = FiguresOf(Json::parse(R"({"command": "calibrate", "model": "complete",
    "after": {"rms_um": 0.3}, "held_out": {"rms_um": 0.4}, "parameters": [
      {"name": "link.link_1", "unit": "um", "value": 312.4, "uncertainty": 4.1}]})"));
  EXPECT_EQ(At(linkage, "linkage.held_out_rms_um").value, 0.4);
  EXPECT_EQ(At(linkage, "linkage.link.link_1_um").value, 312.4);
  EXPECT_EQ(*At(linkage, "linkage.link.link_1_um").u, 4.1);
  const Extract diagnosis = FiguresOf(Json::parse(R"({"command": "diagnose", "verdict": "explained",
    "findings": [{"cause": "backlash", "object": "X", "probability": 0.99, "parameters": [
      {"name": "width_um", "value": 6.0, "u95": 0.2}, {"name": "sensor", "value": "x"}]}]})"));
  EXPECT_EQ(diagnosis.verdict, "explained");
  ASSERT_EQ(diagnosis.findings.size(), 1U);
  EXPECT_EQ(At(diagnosis, "X.backlash_width_um").value, 6.0);
  EXPECT_EQ(At(diagnosis, "X.backlash_width_um").U95(), 0.2);
}

TEST(FiguresOfResult, OfPaths) {
  const Extract extract = FiguresOf(Json::parse(R"({"command": "path", "kind": "square", "tests": [
    {"instrument": "linkage", "largest_um": 5, "sides": [
      {"axis": "X", "straightness_mz_um": 1.0}, {"axis": "X", "straightness_mz_um": 1.5}]}]})"));
  EXPECT_EQ(At(extract, "square.largest_um").value, 5.0);
  EXPECT_EQ(At(extract, "X.side_straightness_um").value, 1.5);
}

TEST(FiguresOfResult, OfOthersNone) {
  EXPECT_TRUE(FiguresOf(Json::parse(R"({"command": "export"})")).figures.empty());
  EXPECT_TRUE(FiguresOf(Json::parse(R"({"command": "reduce", "kind": "sweep"})")).figures.empty());
}

TEST(FiguresOfResult, SaysWhereAKeyHasAnotherForm) {
  const Extract extract = FiguresOf(Json::parse(R"({"command": "reduce", "kind": "sweep",
    "errors": {"EYX": {"unit": "m"}}, "budget": {"EYX": {"noise": "much"}}})"));
  EXPECT_NE(extract.trouble.find("docs/report.md"), std::string::npos);
  EXPECT_TRUE(extract.figures.empty());
}

}  // namespace figures_of_result_test
}  // namespace abbe::history
