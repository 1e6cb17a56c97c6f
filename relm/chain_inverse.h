// The angles of a serial chain for a ball position, by damped Newton steps.
//
//   const ChainInverse inverse(chain);
//   const Eigen::VectorXd angles = inverse.Angles(p_BT, near);
//   const std::vector<Eigen::VectorXd> branches = inverse.Branches(p_BT);
//
// A chain has no closed form in general. The search starts at `near` and takes damped Gauss-Newton
// steps until the ball is reached. It stays on the branch of a start that is near: a path is
// followed from pose to pose. With more than three joints the solution is one of many. Branches()
// starts from a fixed set of angles and returns the distinct solutions, for chains of three joints;
// their order is that of the first angle, then the second, then the third.
// Frames: B, the linkage base; T, the ball.
// Units: m, rad; angles in (-pi, pi] from Branches, near the start from Angles. Shapes: one angle
// per joint, n x 1.
// Failure: Angles throws NumericalError with the remaining distance (out of reach) or for a
// singular pose: smallest singular value of J_tip_q below `singular` times the reach; Find and
// Branches return nothing instead. Never NaN. InputError when `near` has the wrong number of
// angles, and from Branches for a chain that has not three joints.
// Source: Levenberg-Marquardt as in Nocedal, Wright, "Numerical Optimization" (2006), chapter 10.
// Validity: residual below `tolerance`; a branch whose basin none of the starts meets is missed
// (none in the tests).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "relm/serial_chain.h"

namespace abbe::relm {

struct InverseOptions {
  double tolerance = 1e-12;  // of the reach: remaining distance at which the ball is reached
  double singular = 1e-6;    // of the reach
  int max_steps = 100;
};

class ChainInverse {
 public:
  explicit ChainInverse(SerialChain chain, const InverseOptions& options = {});

  // Near the start; throws where Find returns nothing.
  Eigen::VectorXd Angles(const Eigen::Vector3d& p_BT, const Eigen::VectorXd& near) const;
  // The same without exception.
  std::optional<Eigen::VectorXd> Find(const Eigen::Vector3d& p_BT,
                                      const Eigen::VectorXd& near) const;
  // All the solutions that the fixed starts reach; three joints.
  std::vector<Eigen::VectorXd> Branches(const Eigen::Vector3d& p_BT) const;

 private:
  struct Search {
    Eigen::VectorXd angles;
    double miss;      // m
    double singular;  // m: smallest singular value of J_tip_q
  };
  Search Run(const Eigen::Vector3d& p_BT, const Eigen::VectorXd& near) const;

  SerialChain chain_;
  InverseOptions options_;
  double reach_;  // m
};

}  // namespace abbe::relm
