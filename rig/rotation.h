// The rig's own rotations: a body turned by finite angles about the fixed axes x, y, z, one after
// the other. The rig shares no geometry with the models that it is meant to test.
//
//   FullRotation(a, b, c) = Rz(c) * Ry(b) * Rx(a)     right-hand rule, radians, no small angles
#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace abbe::rig {

inline Eigen::Matrix3d FullRotation(double about_x, double about_y, double about_z) {
  const double cx = std::cos(about_x), sx = std::sin(about_x);
  const double cy = std::cos(about_y), sy = std::sin(about_y);
  const double cz = std::cos(about_z), sz = std::sin(about_z);
  Eigen::Matrix3d rotation;
  rotation << cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx,  //
      sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx,          //
      -sy, cy * sx, cy * cx;
  return rotation;
}

inline Eigen::Matrix3d FullRotation(const Eigen::Vector3d& angles) {
  return FullRotation(angles.x(), angles.y(), angles.z());
}

// The displacement of a body: it moves the point p to rotation * p + translation.
struct Displacement {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }
  // `first`, followed by this.
  Displacement operator*(const Displacement& first) const {
    return {rotation * first.rotation, rotation * first.translation + translation};
  }
};

}  // namespace abbe::rig
