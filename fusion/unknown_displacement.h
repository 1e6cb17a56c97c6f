// The covariance of the parameters of a machine whose tool is displaced in an unknown way: what a map
// gains where something is unexplained (simulation/doubt.h).
//
//   cov_pp += UnknownDisplacement(model, p_TQ, 0.3e-6);
//
// All error functions are as unknown as each other, an angle and a squareness over the longest
// travel; together they displace a point by `displacement`, m rms over the travels (a grid of 11 x
// 11 x 11, ends included) and over the three components. Where the gauge makes the errors zero, the
// displacement is zero too. Shapes: in the order of VolumetricModel::Parameters().
#pragma once

#include "machine/volumetric_model.h"

namespace abbe::fusion {

Eigen::MatrixXd UnknownDisplacement(const machine::VolumetricModel& model,
                                    const Eigen::Vector3d& p_TQ, double displacement);

}  // namespace abbe::fusion
