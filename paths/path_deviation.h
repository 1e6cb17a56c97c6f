// The deviation of a measured path from a nominal one.
//
//   const PathDeviation raw = DeviationFrom(path, {});                  // from the commanded path
//   const PathDeviation best = DeviationFrom(path, {.nominal = corners, .align = true});
//
// The nominal path is a chain of straight pieces through the points given, else through the
// commanded positions. The deviation of a pose is measured - the nearest point of the nominal path:
// it does not contain a lag along the path. With `align` the measured path is first moved as a
// rigid body to the least sum of squared distances to the commanded positions: this removes the
// pose of the instrument, and with it machine errors of the same form.
// Frames: axis coordinates. Units: m. Shapes: one column or entry a pose.
// Failure: InputError for a nominal path of fewer than two points. Source: rigid motion by singular
// values, Kabsch, Acta Cryst. A32 (1976). Validity: at a crossing of the nominal path with itself
// the nearer branch counts; coordinates that were not measured are the commanded ones.
#pragma once

#include <Eigen/Core>

#include "geometry/transform.h"
#include "paths/measured_path.h"

namespace abbe::paths {

struct DeviationOptions {
  Eigen::Matrix3Xd nominal{};
  bool align = false;
};

struct PathDeviation {
  Eigen::Matrix3Xd measured;   // after the alignment, if any
  Eigen::Matrix3Xd deviation;  // measured - nearest nominal
  Eigen::VectorXd along;       // arc length of the nearest nominal point, from its beginning
  double length = 0.0;         // of the nominal path
  double largest = 0.0;
  double rms = 0.0;
};

PathDeviation DeviationFrom(const MeasuredPath& path, const DeviationOptions& options);

// The rigid motion X that minimises the sum of squared distances of X * from to `to`, by columns.
geometry::Transform<double> RigidMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

}  // namespace abbe::paths
