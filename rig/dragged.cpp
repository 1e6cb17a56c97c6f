#include "rig/dragged.h"

#include <algorithm>

namespace abbe::rig {

double Play::Follow(double drive) {
  driven_ = begun_ ? std::clamp(driven_, drive - half_, drive + half_) : drive;
  begun_ = true;
  return driven_;
}

Eigen::Vector3d DraggedBall::Follow(const Eigen::Vector3d& cap) {
  if (!begun_) ball_ = cap;
  begun_ = true;
  const Eigen::Vector3d from_cap = ball_ - cap;
  if (from_cap.norm() > displacement_) {
    ball_ = cap + displacement_ / from_cap.norm() * from_cap;
  }
  return ball_ - cap;
}

}  // namespace abbe::rig
