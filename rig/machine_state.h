// The state of the machine at a moment, on which the hidden effects depend.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <map>
#include <string>

namespace abbe::rig {

// m, m/s, s, K; [x y z] as the controller shows them.
struct MachineState {
  double time = 0.0;  // since the machine was switched on
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  // The direction of each axis's last motion: -1 or +1, 0 before the first.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  // The distance of each axis from its last reversal.
  Eigen::Vector3d since_turn = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  int swept = -1;  // axis for whose sweep the head is installed; -1: there is no head
  // The rise of each sensor of the effects since the machine was switched on.
  std::map<std::string, double> warmth;
};

}  // namespace abbe::rig
