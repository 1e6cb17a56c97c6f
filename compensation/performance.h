// Performance simulation: the figures of the standards for a test piece made on a machine with the
// errors of a map, and on the same machine after correction by the map.
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
//   diagonals  ISO 230-6 E_d and B_d (0: a map has no backlash)
//   freeform   the given points: largest and rms distance from their nominal positions
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
// The test of this name, of TestNames().
PerformanceTest MakeTest(std::string_view name, const map::ErrorMap& map, const TestSize& size);

// The positions, 3 x n, that the machine makes of the commands.
Eigen::Matrix3Xd MadeBy(const machine::VolumetricModel& machine, const Eigen::Vector3d& p_TQ,
                        const Eigen::Matrix3Xd& commands);

// The figures after correction, when the machine differs from the map according to its covariance:
// for each figure the bound of the absolute value that 95 % of `draws` drawn machines do not
// exceed. InputError for a map without uncertainty.
std::vector<Figure> AfterCorrection(const map::ErrorMap& map, const Eigen::Vector3d& p_TQ,
                                    const PerformanceTest& test, int draws, std::uint64_t seed);

}  // namespace abbe::compensation
