// The measuring lines of a head that is mounted with small angles and offsets.
//
// The fixture is turned about the origin of H and then shifted; a point p
// of the fixture as drawn goes to R p + offset with R = Rx(roll) Ry(pitch) Rz(yaw), the source's
// order.
//
// Frames: H of head_layout.h.
// Units: m and rad. Shapes: five lines, or a layout, in the order A, B, C, D, E.
// Failure: none; angles must stay well below 1 rad.
// Source: Kweon, Liu, Yang (docs/theory-head.md), the transform before equation 16. Its printed
// entry (2,3), -sin(pitch) sin(roll), must be -cos(pitch) sin(roll), or the matrix is no rotation.
// Validity: InstalledLines is exact. InstalledLayout is the source's first-order form, in which the
// lines keep their direction: only their coordinates in the surface change. It neglects the square
// of the angles times the position (0.04 um for 2 mrad and 10 mm, in the position of a probe, so
// 1e-3 of that in a reading at 1 mrad) and the turn of the measuring lines.
#pragma once

#include "geometry/rotation.h"
#include "probes/head_layout.h"

namespace abbe::probes {

template <typename T = double>
struct Installation {
  T roll{}, pitch{}, yaw{};  // rad, about u, s, n: the source's theta_r, theta_p, theta_y
  T du{}, ds{}, dn{};        // m, along u, s, n: the source's sigma_x, sigma_y, sigma_z
};

// R, exact.
template <typename T>
Eigen::Matrix3<T> InstallationRotation(const Installation<T>& i) {
  return geometry::RotationX(i.roll) * geometry::RotationY(i.pitch) * geometry::RotationZ(i.yaw);
}

// The measuring lines of the installed head, exact. The points are moved along their lines to where
// these meet the nominal surface, so a head without error motion reads zero at d = 0.
template <typename T>
MeasuringLines<T> InstalledLines(const HeadLayout<T>& layout, const Installation<T>& installation) {
  const Eigen::Matrix3<T> R = InstallationRotation(installation);
  const Eigen::Vector3<T> offset(installation.du, installation.ds, installation.dn);
  MeasuringLines<T> lines = LinesOf(layout);
  for (std::size_t i = 0; i < kProbes; ++i) {
    const int normal = i < kTopProbes ? 2 : 1;
    const Eigen::Vector3<T> w = R * lines[i].direction;
    const Eigen::Vector3<T> p = R * lines[i].point + offset;
    lines[i] = {p - w * (p[normal] / w[normal]), w};
  }
  return lines;
}

// The layout of the installed head for the small-angle model, to first order.
template <typename T>
HeadLayout<T> InstalledLayout(const HeadLayout<T>& layout, const Installation<T>& i) {
  HeadLayout<T> installed = layout;
  for (std::size_t k = 0; k < kTopProbes; ++k) {
    const auto& [u, s] = layout.top[k];
    installed.top[k] = {u - i.yaw * s + i.du, s + i.yaw * u + i.ds};
  }
  for (std::size_t k = 0; k < kSideProbes; ++k) {
    const auto& [u, n] = layout.side[k];
    installed.side[k] = {u + i.pitch * n + i.du, n - i.pitch * u + i.dn};
  }
  return installed;
}

}  // namespace abbe::probes
