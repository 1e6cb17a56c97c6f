// What the hidden effects know of the machine at a moment.
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
  // Of each axis's last motion: -1 or +1, 0 before the first.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  // How far each axis is from where it last turned.
  Eigen::Vector3d since_turn = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  int swept = -1;  // axis for whose sweep the head is installed; -1: there is no head
  // How much warmer each sensor is than when the machine was switched on: those of the effects.
  std::map<std::string, double> warmth;
};

}  // namespace abbe::rig
