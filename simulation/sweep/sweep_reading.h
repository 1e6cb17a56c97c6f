// What one probe of the head reads: the equations of sweep_simulation.h, for any number type.
//
// Frames: M, the machine; W, the workpiece body; T, the tool body; H, the head. Units: m, rad. For
// use within simulation/ only; T is double or a dual number.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/rotation.h"
#include "geometry/transform.h"
#include "machine/volumetric_error.h"
#include "probes/electrode.h"
#include "probes/head_settings.h"
#include "simulation/sweep/sweep_run.h"

namespace abbe::simulation {

using probes::kProbes;
using probes::kTopProbes;

inline bool OnTop(std::size_t probe) { return probe < kTopProbes; }

// What one reading of one probe depends on.
template <typename T>
struct Circumstances {
  Eigen::Vector2<T> place;                  // of the probe in the face: u and s or n, m
  T gain;                                   // what it shows = gain * gap
  Eigen::Vector3<T> turn, shift;            // installation of the head: about and along u, s, n
  Eigen::Vector3<T> tilt, face_squareness;  // of the target
};

// The parts of a sweep that no parameter changes.
struct SweepPlan {
  machine::Chain chain;
  int axis;
  Eigen::Matrix3d R_MH;
  Eigen::Vector3d head_T, corner_W;  // origin of H on the tool body, corner of the target, from the
                                     // machine's reference point
  probes::Electrode electrode;
  probes::PerProbe<> height;  // m: of an electrode over its face
};

template <typename T>
Eigen::Matrix3<T> FaceTurn(int axis, const Eigen::Vector3<T>& squareness) {
  const T zero(0);
  if (axis == 0) return geometry::ExpRotation<T>({zero, squareness[1], squareness[2]});
  if (axis == 1) return geometry::ExpRotation<T>({squareness[0], zero, zero});
  return Eigen::Matrix3<T>::Identity();
}

// The outward normal of the face that looks along `nominal`, an axis direction of M.
template <typename T>
Eigen::Vector3<T> FaceNormal(const Eigen::Vector3d& nominal, const Circumstances<T>& at) {
  Eigen::Index axis = 0;
  nominal.cwiseAbs().maxCoeff(&axis);
  const Eigen::Matrix3<T> R = geometry::ExpRotation<T>(at.tilt);
  return R * (FaceTurn<T>(static_cast<int>(axis), at.face_squareness) * nominal.cast<T>());
}

// X_WT: where the tool body stands as the workpiece sees it.
template <typename T>
geometry::Transform<T> ToolSeenFromWork(const SweepPlan& plan, const Eigen::Vector3d& axes,
                                        const machine::MotionErrors<T>& errors) {
  const Eigen::Vector3<T> position = axes.cast<T>();
  const auto X_MW = machine::WorkpiecePose<T>(plan.chain, position, errors);
  return X_MW.Inverse() * machine::ToolPose<T>(plan.chain, position, errors);
}

inline double ValueOf(double value) { return value; }
template <typename T>
double ValueOf(const T& jet) {
  return jet.a;
}

// A probe and the face that it looks at, in W.
template <typename T>
struct Sight {
  Eigen::Vector3<T> place, direction, normal;

  // The tilt of the face against the electrode, rad.
  double Tilt() const {
    return std::acos(std::min(1.0, std::abs(ValueOf(T(normal.dot(direction))))));
  }
};

template <typename T>
Sight<T> SightOf(const SweepPlan& plan, std::size_t probe, const geometry::Transform<T>& X_WT,
                 const Circumstances<T>& at) {
  const Eigen::Matrix3<T> R_MH = plan.R_MH.cast<T>();
  const Eigen::Matrix3<T> R = R_MH * geometry::RotationX(at.turn.x()) *
                              geometry::RotationY(at.turn.y()) * geometry::RotationZ(at.turn.z());
  const int normal = OnTop(probe) ? 2 : 1;
  const T height(plan.height[probe]);
  const Eigen::Vector3<T> in_head = OnTop(probe)
                                        ? Eigen::Vector3<T>(at.place[0], at.place[1], height)
                                        : Eigen::Vector3<T>(at.place[0], height, at.place[1]);
  Eigen::Vector3<T> shift = at.shift;
  shift[normal] = T(0);  // the zero contains it: the two cannot be separated
  const Eigen::Vector3<T> p_T = plan.head_T.cast<T>() + R * in_head + R_MH * shift;
  return {X_WT * p_T, X_WT.R * Eigen::Vector3<T>(-R.col(normal)),
          FaceNormal<T>(plan.R_MH.col(normal), at)};
}

template <typename T>
T ReadingOf(const SweepPlan& plan, std::size_t probe, const geometry::Transform<T>& X_WT,
            const Circumstances<T>& at) {
  const Sight<T> sight = SightOf<T>(plan, probe, X_WT, at);
  const T gap =
      sight.normal.dot(plan.corner_W.cast<T>() - sight.place) / sight.normal.dot(sight.direction);
  if (plan.electrode.radius == 0.0 && plan.electrode.stray == 0.0) return at.gain * gap;
  // A tilt changes the reading in second order only: its own derivative is left out.
  return at.gain * probes::ElectrodeReading(plan.electrode, gap, sight.Tilt());
}

// The parts of a run of this head that no parameter changes.
SweepPlan MakeSweepPlan(const machine::Chain& chain, const Eigen::Vector3d& reference,
                        const probes::HeadSettings& head, const SweepRun& run);

// Where a probe stands in its face: u and s of a top probe, u and n of a side probe, m.
Eigen::Vector2d PlaceOf(const probes::HeadLayout<>& layout, std::size_t probe);

}  // namespace abbe::simulation
