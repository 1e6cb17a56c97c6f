// Cylindricity about the least-squares cylinder.
//
// Frames: the axis runs near +z; x and y from any point near it. A deviation is the distance to the
// axis minus the radius, positive outside. Units: m. Shapes: points in columns, 3 x n.
// Failure: InputError for fewer than six points, points that fix no cylinder, numbers that are not
// finite; NumericalError when the iteration does not settle.
// Source: ISO 12180-1:2011, clause 3 (definition; not checked against its text); Gauss-Newton on
// the place and tilt of the axis and the radius, until they rest at the least squares to rounding.
// Validity: an axis within some degrees of z. Cylindricity is the minimum zone in the standard;
// about the least-squares cylinder it is somewhat larger.
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
