// What the five probes read when the swept axis has moved by d with its six errors.
//
// Frame H = (u, s, n) of head_layout.h; errors carry the source's letters x, y, z for u, s, n. A
// reading is the change of the coordinate of the surface under the probe since the sweep started
// without error, along the outward normal: Delta = zero_gap - gap, positive when the target comes
// nearer. Signs: d > 0 when the moving body goes towards +u; angles follow the right-hand rule.
//
// Two models, each for both bodies that may move:
//   DocumentReadings  the source's model: the pose of the moved body is d plus the small-angle
//                     matrix I + [EAX EBX ECX]x, which is solved exactly but is no rotation,
//   RigidReadings     the moved body turns by the full rotation exp([EAX EBX ECX]x), which knows no
//                     order of the three angles; the plane of the target is cut by the measuring
//                     line of the probe, whichever way the line points.
// They differ by half a product of two angles times the lever: 0.04 um at 1 mrad and 60 mm.
//
// Units: m and rad. Shapes: five readings in the order A, B, C, D, E. T is any scalar, also a jet
// of Ceres. Failure: none; the angles must stay well below 1 rad, where a line meets the plane.
// Source: Kweon, Liu, Yang (docs/theory-head.md), equations 2 to 7. The matrix printed there has
// lost the sign of its -EBX entry; the equations are right. The case of a moving head is the
// project's. Validity: a rigid target with flat faces that are square to each other.
#pragma once

#include <array>

#include "geometry/transform.h"
#include "probes/head_layout.h"

namespace abbe::probes {

// Which body the swept axis carries: the target (a table axis) or the head (a column axis).
enum class MovingBody { kTarget, kHead };

// The error motions of the swept axis at the travel d, in the letters of an X axis.
template <typename T = double>
struct HeadErrors {
  T eax{};  // rad: roll, about u
  T ebx{};  // rad: pitch, about s
  T ecx{};  // rad: yaw, about n
  T eyx{};  // m: side straightness, along s
  T ezx{};  // m: top straightness, along n
  T exx{};  // m: positioning, along u; known from elsewhere or zero, no probe sees it
};

// Equation 2, with EZX before the fraction: the top surface under a probe at (x, y), target moving.
template <typename T>
T DocumentTop(const HeadErrors<T>& e, const T& x, const T& y, const T& d) {
  const T lever = d - x + e.exx;
  const T scale = T(1) / (T(1) + e.ecx * e.ecx);
  return e.ezx + scale * (e.eax * (y - e.eyx + lever * e.ecx) +  //
                          e.ebx * (lever + (e.eyx - y) * e.ecx));
}

// Equations 6 and 7: the side surface under a probe at (x, z), target moving.
template <typename T>
T DocumentSide(const HeadErrors<T>& e, const T& x, const T& z, const T& d) {
  const T lever = d - x + e.exx;
  const T scale = T(1) / (T(1) + e.ebx * e.ebx);
  return e.eyx + scale * (e.eax * (e.ezx - z + lever * e.ebx) -  //
                          e.ecx * (lever + (z - e.ezx) * e.ebx));
}

template <typename T>
PerProbe<T> DocumentReadings(const HeadLayout<T>& layout, MovingBody moving, const HeadErrors<T>& e,
                             const T& d) {
  PerProbe<T> delta;
  for (std::size_t i = 0; i < kTopProbes; ++i) {
    const auto& [x, y] = layout.top[i];
    delta[i] = moving == MovingBody::kTarget ? DocumentTop(e, x, y, d)
                                             : T(-(e.ezx + y * e.eax - x * e.ebx));
  }
  for (std::size_t i = 0; i < kSideProbes; ++i) {
    const auto& [x, z] = layout.side[i];
    delta[kTopProbes + i] = moving == MovingBody::kTarget ? DocumentSide(e, x, z, d)
                                                          : T(-(e.eyx - z * e.eax + x * e.ecx));
  }
  return delta;
}

// The moved body's frame seen from where it would be at d = 0 without error.
template <typename T>
geometry::Transform<T> MovedPose(const HeadErrors<T>& e, const T& d) {
  geometry::ErrorVector<T> errors;
  errors << d + e.exx, e.eyx, e.ezx, e.eax, e.ebx, e.ecx;
  return geometry::ErrorTransform(errors);
}

template <typename T>
PerProbe<T> RigidReadings(const MeasuringLines<T>& lines, MovingBody moving, const HeadErrors<T>& e,
                          const T& d) {
  const geometry::Transform<T> X = MovedPose(e, d);
  PerProbe<T> delta;
  for (std::size_t i = 0; i < kProbes; ++i) {
    const int normal = i < kTopProbes ? 2 : 1;  // of the surface, in the target's frame
    const auto& [p, w] = lines[i];
    if (moving == MovingBody::kTarget) {  // X = X_HT: the plane with normal m through X.p
      const Eigen::Vector3<T> m = X.R.col(normal);
      delta[i] = m.dot(X.p - p) / m.dot(w);
    } else {  // X = X_TH: the plane with normal m = row of X.R, at the distance X.p along it
      const Eigen::Vector3<T> m = X.R.row(normal);
      delta[i] = -(X.p[normal] + m.dot(p)) / m.dot(w);
    }
  }
  return delta;
}

}  // namespace abbe::probes
