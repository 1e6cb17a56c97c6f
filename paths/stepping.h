// The stepping test: the machine moves along one axis in steps (0, 5, ... 25 mm) and stops at each;
// compares the measured displacements with these steps. One line each for X, Y and Z.
//
// A displacement is the position of a stop minus that of the first stop of its line, so a constant
// offset of the instrument does not matter. Stops that are visited again are averaged; what the
// visits to a stop differ by, over all stops, is in u, where it is more than the scatter within.
// Frames: axis coordinates. Units: m. Failure: InputError with the recording when there are not two
// stops that differ in one axis alone. Source: the stepping motion test of Boelens, "Error
// Parameter Model" (2006). Validity: the errors of instrument and machine are not separated.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "paths/measured_path.h"

namespace abbe::paths {

struct SteppingStop {
  double commanded;           // m along the axis, from the first stop
  Eigen::Vector3d deviation;  // measured minus commanded displacement
  double u;  // m: standard uncertainty of one coordinate, by the scatter of visits and within them
  int visits;
};

struct SteppingLine {
  char axis;
  std::vector<SteppingStop> stops;  // by commanded position
  double largest_along = 0.0;       // m: largest deviation along the axis, without sign
  double largest = 0.0;             // m: largest length of a deviation
};

std::vector<SteppingLine> EvaluateStepping(const MeasuredPath& path);

}  // namespace abbe::paths
