// The volumetric error: the position of the tool point relative to the workpiece, actual minus
// nominal. Exact for any chain of three linear axes; the equations below are the whole model.
//
// Frames: W the workpiece, T the tool body, and one for the carriage of each axis. With the axes at
// zero all of them coincide: parallel to M, the origin in the machine's reference point. The bed is
// M. The tool vector p_TQ is the tool point Q seen from that origin.
// Position: [X Y Z] as the control shows, m. The chain defines the signs (chain.h): with s the
// CarriageSense of an axis, its carriage is at s q when the control shows q. The positioning error
// is counted like q, as in ISO 230-2, so it displaces the carriage by s EXX. The other five errors
// are motions of the carriage in M and do not depend on s.
// Units: m, rad. Shapes: position, p_TQ and the result 3 x 1. T: double, or dual numbers for
// derivatives.
// Failure: none; a value that is not finite passes through.
//
//   carriage    X_ab = { R = exp([EA EB EC]),  p = s q l + [EX EY EZ] }    b on a, first on the bed
//   lines       l_X = x,  l_Y = exp(C0Y z) y,  l_Z = exp(A0Z x + B0Z y) z
//   workpiece   X_MW = product of the carriages from b to w
//   tool body   X_MT = product of the carriages from b to t
//   error       p_WQ - nominal = X_MW^-1 X_MT p_TQ - (p_TQ + [t_X X, t_Y Y, t_Z Z])    t: ToolSense
//
// The X line is the primary and the XY plane the secondary: C0Y turns the Y line about +z, A0Z and
// B0Z turn the Z line about +x and +y (signs of standards/squareness.h).
// Source: own product of full rotations; to first order it is the column machine of the volumetric
// error lecture and equations 20 and 21 of Ha and Khanh (2011), docs/theory-volumetric.md.
// Validity: rigid bodies whose errors depend on their own axis only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "geometry/transform.h"
#include "machine/chain.h"
#include "machine/error_motion.h"

namespace abbe::machine {

template <typename T>
struct MotionErrors {
  std::array<geometry::ErrorVector<T>, kAxes> axes;          // of X, Y, Z at their positions
  Eigen::Vector3<T> squareness = Eigen::Vector3<T>::Zero();  // [A0Z B0Z C0Y]

  MotionErrors() { axes.fill(geometry::ErrorVector<T>::Zero()); }
};

// The rotation vector of the line of an axis from its nominal direction, rad.
template <typename T>
Eigen::Vector3<T> LineTurn(int axis, const Eigen::Vector3<T>& squareness) {
  if (axis == 0) return {T(0), T(0), T(0)};
  if (axis == 1) return {T(0), T(0), squareness.z()};
  return {squareness.x(), squareness.y(), T(0)};
}

// The unit vector l of the line of an axis, in M.
template <typename T>
Eigen::Vector3<T> LineOf(int axis, const Eigen::Vector3<T>& squareness) {
  return geometry::ExpRotation<T>(LineTurn<T>(axis, squareness)).col(axis);
}

// X_ab of one carriage; `sense` is the CarriageSense of the axis.
template <typename T>
geometry::Transform<T> CarriagePose(int axis, double sense, const T& position,
                                    const MotionErrors<T>& errors) {
  geometry::Transform<T> X = geometry::ErrorTransform<T>(errors.axes[axis]);
  X.p[axis] *= sense;
  X.p += sense * position * LineOf<T>(axis, errors.squareness);
  return X;
}

// The pose in M of the body carried by these axes, in the order from the bed.
template <typename T>
geometry::Transform<T> BodyPose(const Chain& chain, const std::string& axes_from_bed,
                                const Eigen::Vector3<T>& position, const MotionErrors<T>& errors) {
  geometry::Transform<T> X;
  for (const char letter : axes_from_bed) {
    const int axis = letter - 'X';
    X = X * CarriagePose<T>(axis, chain.CarriageSense(letter), position[axis], errors);
  }
  return X;
}

// X_MW.
template <typename T>
geometry::Transform<T> WorkpiecePose(const Chain& chain, const Eigen::Vector3<T>& position,
                                     const MotionErrors<T>& errors) {
  const std::string& from_workpiece = chain.workpiece_axes();
  return BodyPose<T>(chain, {from_workpiece.rbegin(), from_workpiece.rend()}, position, errors);
}

// X_MT.
template <typename T>
geometry::Transform<T> ToolPose(const Chain& chain, const Eigen::Vector3<T>& position,
                                const MotionErrors<T>& errors) {
  return BodyPose<T>(chain, chain.tool_axes(), position, errors);
}

// p_WQ of a perfect machine.
template <typename T>
Eigen::Vector3<T> NominalToolInWork(const Chain& chain, const Eigen::Vector3<T>& position,
                                    const Eigen::Vector3<T>& p_TQ) {
  Eigen::Vector3<T> p_WQ = p_TQ;
  for (const char axis : {'X', 'Y', 'Z'}) {
    p_WQ[axis - 'X'] += chain.ToolSense(axis) * position[axis - 'X'];
  }
  return p_WQ;
}

// p_WQ of the machine with these errors.
template <typename T>
Eigen::Vector3<T> ToolInWork(const Chain& chain, const Eigen::Vector3<T>& position,
                             const Eigen::Vector3<T>& p_TQ, const MotionErrors<T>& errors) {
  const auto X_MW = WorkpiecePose<T>(chain, position, errors);
  return X_MW.Inverse() * (ToolPose<T>(chain, position, errors) * p_TQ);
}

// The error of p_WQ, actual - nominal.
template <typename T>
Eigen::Vector3<T> VolumetricError(const Chain& chain, const Eigen::Vector3<T>& position,
                                  const Eigen::Vector3<T>& p_TQ, const MotionErrors<T>& errors) {
  return ToolInWork<T>(chain, position, p_TQ, errors) - NominalToolInWork<T>(chain, position, p_TQ);
}

}  // namespace abbe::machine
