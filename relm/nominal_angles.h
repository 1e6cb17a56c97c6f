// The encoder angles of a perfect linkage for a ball position.
//
//   const Eigen::VectorXd angles = NominalAngles(settings, settings.X_MB.Inverse() * p_MT);
//
// Form "pivots" takes the closed form on the branch of the machine file. For any other chain a
// search starts at `near`, without it at half a radian for each joint: give the angles of a
// neighbouring pose to stay on a branch.
// Frames: B, the linkage base; T, the ball.
// Units: m, rad. Shapes: one angle per joint, n x 1.
// Failure: NumericalError when the ball is out of reach or the pose singular, with what to do.
// Source: pivot_linkage.h, chain_inverse.h.
// Validity: pivot_linkage.h, chain_inverse.h.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "relm/linkage_settings.h"

namespace abbe::relm {

// `near`: angles of a neighbouring pose.
Eigen::VectorXd NominalAngles(const LinkageSettings& settings, const Eigen::Vector3d& p_BT,
                              const std::optional<Eigen::VectorXd>& near = {});

}  // namespace abbe::relm
