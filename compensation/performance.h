// Performance simulation: what a machine with these errors makes of a test piece, with the figures
// of the standards, and what it makes of it when its map corrects it.
//
//   const PerformanceTest test = MakeTest("circle", map, {});
//   const std::vector<Figure> as_is = test.evaluate(MadeBy(map.model(), p_TQ, test.wanted));
//
// Tests, in the middle of the travels, within 98 % of them:
//   length     along X, Y, Z and the four body diagonals: error of the whole length and the largest
//              of any two points
//   circle     in XY, YZ, ZX: ISO 230-4 G, F_max, F_min about the middle
//   square     in XY, YZ, ZX: straightness of the worst side and squareness of the worst corner,
//              ISO 230-1, least-squares lines
//   cylinder   along Z: cylindricity, mean diameter, tilt of the axis
//   diagonals  ISO 230-6 E_d and B_d (0: a map knows no reversal)
//   freeform   the points given: largest and rms distance from where they should be
// Frames: axis positions; made = Corrector::Made. Units: figures in m or rad, `unit` prints them.
// Failure: InputError for an unknown test, a piece larger than the travels, a freeform point
// outside.
// Source: the uses of an error map named in the volumetric error lecture; the standards as given in
// standards/. Validity: quasi-static geometric errors; no dynamics, tool or clamping.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "compensation/corrector.h"

namespace abbe::compensation {

struct Figure {
  std::string name;
  double value = 0.0;
  std::string unit;  // "um" or "urad"
};

struct PerformanceTest {
  Eigen::Matrix3Xd wanted;  // m
  std::function<std::vector<Figure>(const Eigen::Matrix3Xd& made)> evaluate;
};

struct TestSize {
  double radius = 0.0;    // of circle and cylinder, half the side of the square, m; 0: 0.4 of the
                          // shortest travel
  Eigen::Matrix3Xd path;  // of freeform, m
};

std::vector<std::string_view> TestNames();
PerformanceTest MakeTest(std::string_view name, const map::ErrorMap& map, const TestSize& size);

Eigen::Matrix3Xd MadeBy(const machine::VolumetricModel& machine, const Eigen::Vector3d& p_TQ,
                        const Eigen::Matrix3Xd& commands);

// The figures that remain when the map corrects the commands and the machine differs from the map
// as its covariance says: of each figure the value whose size 95 % of `draws` drawn machines stay
// below. InputError for a map that states no uncertainty.
std::vector<Figure> AfterCorrection(const map::ErrorMap& map, const Eigen::Vector3d& p_TQ,
                                    const PerformanceTest& test, int draws, std::uint64_t seed);

}  // namespace abbe::compensation
