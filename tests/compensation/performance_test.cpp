#include "compensation/performance.h"

#include <algorithm>
#include <map>

#include "failure/failure.h"
#include "map_cases.h"

namespace abbe::compensation {
namespace performance_test {

using Eigen::Vector3d;
using map::ErrorMap;

// A bridge machine of 100 mm with these coefficients only: EXX and EYY in proportion, C0Y.
ErrorMap Scaled(double sx, double sy, double c0y) {
  machine::VolumetricModel model(machine::Chain::Parse("[w b X Y Z t]"),
                                 {{{0, 0.1}, {0, 0.1}, {0, 0.1}}});
  const auto line = machine::MakePolynomialForm(1, 0.0, 0.1);
  model.SetForm(0, 0, line);
  model.SetForm(1, 1, line);
  model.SetCoefficients(0, 0, Eigen::Vector2d(0, sx * 0.05));
  model.SetCoefficients(1, 1, Eigen::Vector2d(0, sy * 0.05));
  model.SetSquareness({0, 0, c0y});
  return {{}, model, {}};
}

std::map<std::string, double> FiguresOf(const ErrorMap& map, const char* name, TestSize size = {}) {
  const PerformanceTest test = MakeTest(name, map, size);
  std::map<std::string, double> figures;
  for (const Figure& f : test.evaluate(MadeBy(map.model(), Vector3d::Zero(), test.wanted))) {
    figures[f.name] = f.value * 1e6;
  }
  return figures;
}

// Closed forms. Scale: a length grows by s L; C0Y = c tilts Y by -c: corners and diagonals feel it.
TEST(Performance, TheFiguresOfScaleAndSquarenessAreTheClosedForms) {
  const double s = 40e-6, c = 60e-6, second_order = 0.02;  // um: 98 mm times (100e-6)^2, and more
  auto figures = FiguresOf(Scaled(s, 0, 0), "length");
  EXPECT_NEAR(figures["length X"], 98e3 * s, second_order);
  EXPECT_NEAR(figures["any length X"], 98e3 * s, second_order);
  EXPECT_NEAR(figures["length Y"], 0.0, second_order);
  EXPECT_NEAR(figures["length +X+Y+Z"], 98e3 * s / std::sqrt(3.0), second_order);
  figures = FiguresOf(Scaled(0, 0, c), "square");
  EXPECT_NEAR(std::abs(figures["squareness XY"]), 60.0, 0.01);
  EXPECT_NEAR(figures["squareness YZ"], 0.0, 0.01);
  EXPECT_NEAR(figures["straightness XY"], 0.0, second_order);
  // ISO 230-4: squareness gives -(c R / 2) sin 2t, scale R (sx - sy) / 2 cos 2t: G = R |.|.
  TestSize size;
  size.radius = 0.030;
  figures = FiguresOf(Scaled(0, 0, c), "circle", size);
  EXPECT_NEAR(figures["G XY"], 30e3 * c, second_order);
  EXPECT_NEAR(figures["G YZ"], 0.0, second_order);
  // About the middle of the travel the path is off by the errors there: -c Y and s X.
  figures = FiguresOf(Scaled(s, -s, 0), "circle", size);
  EXPECT_NEAR(figures["G XY"], 2 * 30e3 * s, second_order);
  figures = FiguresOf(Scaled(s, s, 0), "cylinder", size);
  EXPECT_NEAR(figures["diameter"], 2 * 30e3 * s, second_order);
  EXPECT_NEAR(figures["cylindricity"], 0.0, second_order);
  // C0Y shortens one pair of diagonals and lengthens the other by L c x y / d^2, alike.
  figures = FiguresOf(Scaled(0, 0, c), "diagonals");
  EXPECT_NEAR(figures["E_d"], 98e3 * c / std::sqrt(3.0), second_order);
  EXPECT_NEAR(figures["E +X+Y+Z"], figures["E +X-Y+Z"], second_order);
  EXPECT_EQ(figures["B_d"], 0.0);
}

TEST(Performance, ASkewSpindleColumnTiltsTheCylinder) {
  machine::VolumetricModel model(machine::Chain::Parse("[w b X Y Z t]"),
                                 {{{0, 0.1}, {0, 0.1}, {0, 0.1}}});
  model.SetSquareness({30e-6, -40e-6, 0});
  auto figures = FiguresOf({{}, model, {}}, "cylinder");
  EXPECT_NEAR(figures["tilt of the axis"], 50.0, 0.01);
  EXPECT_NEAR(figures["cylindricity"], 0.0, 0.01);
}

TEST(Performance, AFreeformPathIsOffByTheMap) {
  const ErrorMap map = map::RandomMap(2, map::kBridge);
  TestSize size;
  size.path = Eigen::Matrix3Xd(3, 2);
  size.path << 0.01, 0.02, 0.03, 0.04, 0.05, 0.01;
  const auto figures = FiguresOf(map, "freeform", size);
  const double a = map.Error(size.path.col(0), Vector3d::Zero()).norm() * 1e6;
  const double b = map.Error(size.path.col(1), Vector3d::Zero()).norm() * 1e6;
  EXPECT_NEAR(figures.at("largest"), std::max(a, b), 1e-9);
  EXPECT_NEAR(figures.at("rms"), std::sqrt((a * a + b * b) / 2), 1e-9);
}

// For one point after correction the distances are those of the covariance of the map.
TEST(Performance, WhatRemainsAfterCorrectionIsTheUncertainty) {
  const ErrorMap map = map::RandomMap(2);
  TestSize size;
  size.path = Vector3d(0.03, 0.02, 0.04);
  const PerformanceTest test = MakeTest("freeform", map, size);
  const Vector3d tool = map.origin().tool;
  const auto after = AfterCorrection(map, tool, test, 1000, 7);
  const double variance = map.Covariance(size.path.col(0), tool).trace();
  // The 95 % point of a sum of squares lies between that of one direction and of three alike.
  const double total = std::sqrt(variance);
  EXPECT_GT(after[0].value, 1.5 * total);
  EXPECT_LT(after[0].value, 2.1 * total);
  const auto again = AfterCorrection(map, tool, test, 1000, 7);
  EXPECT_EQ(after[0].value, again[0].value);
}

TEST(Performance, CorrectionMakesEveryTestBetter) {
  const ErrorMap map = map::RandomMap(9, map::kColumn, 0.02);
  for (const std::string_view name : TestNames()) {
    if (name == "freeform") continue;
    const PerformanceTest test = MakeTest(name, map, {});
    const auto before = test.evaluate(MadeBy(map.model(), map.origin().tool, test.wanted));
    const auto after = AfterCorrection(map, map.origin().tool, test, 20, 1);
    const auto largest = [](const std::vector<Figure>& figures) {
      double value = 0.0;
      for (const Figure& f : figures) value = std::max(value, std::abs(f.value));
      return value;
    };
    EXPECT_LT(largest(after), 0.5 * largest(before)) << name;
  }
}

TEST(Performance, RefusesWhatItCannotDo) {
  const ErrorMap map = map::RandomMap(2);
  const auto refusal = [&](const char* name, const TestSize& size) {
    return map::MessageOf<InputError>([&] { MakeTest(name, map, size); });
  };
  map::ExpectHas(refusal("cone", {}), "length, circle");
  map::ExpectHas(refusal("freeform", {}), "--path");
  TestSize size;
  size.radius = 0.0301;
  map::ExpectHas(refusal("circle", size), "does not fit");
  const ErrorMap bare(map.origin(), map.model(), {});
  map::ExpectHas(map::MessageOf<InputError>([&] {
                   AfterCorrection(bare, Vector3d::Zero(), MakeTest("circle", bare, {}), 20, 1);
                 }),
                 "has no uncertainty");
}

}  // namespace performance_test
}  // namespace abbe::compensation
