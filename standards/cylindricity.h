// Cylindricity about the least-squares cylinder.
//
// Frames: the axis is near +z; x and y from any origin near it. A deviation is the distance to the
// axis minus the radius, positive outside. Units: m. Shapes: points in columns, 3 x n.
// Failure: InputError for fewer than six points, points that do not determine a cylinder, numbers
// that are not finite; NumericalError when the iteration does not converge.
// Source: ISO 12180-1:2011, clause 3 (definition; not checked against its text); Gauss-Newton in
// the place and tilt of the axis and the radius, converged to rounding. Validity: an axis within a
// few degrees of z. Cylindricity is the minimum zone in the standard; about the least-squares
// cylinder the figure is somewhat larger.
#pragma once

#include <Eigen/Core>

namespace abbe::standards {

struct Cylindricity {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // of the axis at the mean height
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();    // d x / d z, d y / d z of the axis, rad
  double radius = 0.0;
  double error = 0.0;  // largest minus smallest deviation
};

Cylindricity EvaluateCylindricity(const Eigen::Matrix3Xd& points);

}  // namespace abbe::standards
