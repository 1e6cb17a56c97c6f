// What the screws of a set-up do to the five gaps.
//
// A body rests on its supports. A screw that moves the body by q along its direction w at its tip p
// shifts it by t and turns it by the small angles r, so that at each support
//
//   w . (t + r x p) = q        (0 at the supports that are not turned)
//
// With fewer than six supports the body moves the least that satisfies this, a turn counted as the
// displacement that it causes at the mean distance of the supports. The gap of a probe changes by
// minus the displacement of the target along the outward normal at the place under the probe, or by
// that of the head at the probe.
//
// Frames: H = (u, s, n) of head_layout.h. Units: m, rad. Shapes: a matrix of probes x screws, in m
// of gap for 1 m of screw. Failure: none.
// Source: the project's; the displacement of a rigid body by a small turn.
// Validity: first order in the angles: 0.5 um for 1 mrad and 1 mm of displacement along u, and the
// faces plane.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "probes/align_settings.h"
#include "probes/head_layout.h"
#include "probes/head_model.h"

namespace abbe::probes {

using ScrewResponse = Eigen::Matrix<double, kProbes, Eigen::Dynamic>;

// A small motion of the target in H: [shift along u s n, turn about u s n], m and rad.
using SmallMotion = Eigen::Matrix<double, 6, 1>;

class ScrewMotion {
 public:
  ScrewMotion(const HeadLayout<>& layout, MovingBody moving, const Eigen::Matrix3d& R_MH,
              const std::vector<Screw>& screws);

  // At `travel`: m of the carriage along u since the start of the sweep.
  ScrewResponse At(double travel) const;
  // What a motion of the target does to the gaps.
  Eigen::Matrix<double, kProbes, 6> OfTarget(double travel) const;
  // +1 where the place under the probes goes to +u of the target with the carriage, else -1.
  double way() const { return way_; }
  // The motion of each body for 1 m of each screw, 6 x screws; zero for the screws of the other.
  const Eigen::MatrixXd& MotionOf(ScrewedBody body) const {
    return body == ScrewedBody::kTarget ? of_target_ : of_head_;
  }

 private:
  Eigen::Matrix<double, kProbes, 6> Reach(double along) const;

  HeadLayout<> layout_;
  double way_;
  Eigen::MatrixXd of_target_, of_head_;
};

}  // namespace abbe::probes
