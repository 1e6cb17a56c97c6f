// The volumetric error with its derivatives in closed form.
//
// With a the frame before a carriage (on its bed side), R_Wa its orientation in W and arm = p_aQ -
// p_ab the vector from the carriage to the tool point, small changes of the carriage move the tool
// point in W by
//
//   + R_Wa { d[EX EY EZ] + s l dq + s q dl - arm x (J d[EA EB EC]) }     + on the tool side, else -
//
// The positioning error among EX EY EZ is multiplied by s, as in volumetric_error.h; J is the left
// Jacobian of the rotation, ExpRotationJacobian.
// Frames, units, signs: volumetric_error.h.
// Units: m, rad. Shapes: 3 x 18 by the motions, axis by axis; 3 x 3 by squareness, position and
// tool.
// Failure: none; a value that is not finite passes through.
// Source: own.
// Validity: as volumetric_error.h, without a small angle; equal to dual numbers to rounding.
#pragma once

#include <Eigen/Core>

#include "machine/volumetric_error.h"

namespace abbe::machine {

struct VolumetricJacobian {
  Eigen::Vector3d error;
  Eigen::Matrix<double, 3, kAxes * kMotions> J_error_motions;  // axis by axis, error_motion.h
  Eigen::Matrix3d J_error_squareness;                          // by [A0Z B0Z C0Y]
  Eigen::Matrix3d J_error_position;                            // by [X Y Z], the motions held
  Eigen::Matrix3d J_error_tool;                                // by p_TQ
};

// d LineOf(axis, squareness) / d squareness.
Eigen::Matrix3d LineJacobian(int axis, const Eigen::Vector3d& squareness);

// Error and derivatives at one position.
VolumetricJacobian VolumetricErrorAndJacobian(const Chain& chain, const Eigen::Vector3d& position,
                                              const Eigen::Vector3d& p_TQ,
                                              const MotionErrors<double>& errors);

}  // namespace abbe::machine
