// The test pieces of a performance simulation (performance.h): their nominal positions
// and the figures of the positions made.
//
// To add one: a maker here, in a file of its own if it is long, and a line in performance.cpp.
#pragma once

#include <Eigen/Core>

#include "compensation/performance.h"

namespace abbe::compensation {

// The box available to test pieces: middle -+ half.
struct Volume {
  Eigen::Vector3d middle, half;  // m
};

PerformanceTest Lengths(const Volume& volume, const TestSize& size);
PerformanceTest Circles(const Volume& volume, const TestSize& size);
PerformanceTest Squares(const Volume& volume, const TestSize& size);
PerformanceTest Cylinder(const Volume& volume, const TestSize& size);
PerformanceTest Freeform(const Volume& volume, const TestSize& size);
PerformanceTest Diagonals(const Volume& volume, const TestSize& size);

}  // namespace abbe::compensation
