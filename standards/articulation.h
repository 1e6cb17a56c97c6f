// Single-point articulation: the ball rests in one seat while the linkage takes many poses. The
// scatter of the measured centres is the error of the linkage itself; no reference is needed.
//
// Frames: p holds the measured ball centres in columns, in the linkage base or the machine.
// Units: m. Shapes: 3 x n. Failure: InputError for fewer than two poses or numbers that are not
// finite.
//
//   location       ISO 10360-12 location value: the diameter of the smallest sphere that holds all
//                  centres (the standard takes the centres of five articulations)
//   largest        ASME B89.4.22: largest distance to the mean centre
//   range          largest minus smallest distance to the mean centre
//   two_sigma      ASME B89.4.22: 2 sqrt(sum d_i^2 / (n - 1))
//
// Source: ISO 10360-12:2016 (articulated location error, L_Dia) and ASME B89.4.22-2004, not checked
// against their texts. Smallest sphere: an active-set method after Gaertner (1999). For up to five
// points all choices of one to four points on the surface are tried; points outside the sphere are
// added until there are none. Validity: exact up to rounding.
#pragma once

#include <Eigen/Core>

namespace abbe::standards {

struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

// InputError without points or for numbers that are not finite.
Sphere SmallestEnclosingSphere(const Eigen::Matrix3Xd& p);

struct Articulation {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double location = 0.0;
  double largest = 0.0;
  double range = 0.0;
  double two_sigma = 0.0;
  Eigen::VectorXd distances;  // n: from the mean centre
};

Articulation EvaluateArticulation(const Eigen::Matrix3Xd& p);

}  // namespace abbe::standards
