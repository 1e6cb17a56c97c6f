// The screws under and beside the rig's target, of the machine file's table [align], and where the
// target sits when they are turned.
//
//   TargetScrews screws(settings, corner);
//   screws.Turn("front", -0.35);
//   const Displacement seat = screws.Seat();
//
// Exact: the plane of the target that touches a support contains the tip of its screw, which has
// moved along its direction. The seat is found by Newton's method with full rotations; where the
// supports leave a motion free, it is the least one. The rig shares no code with the models.
//
// Source: the project's. Validity: supports that keep contact, without friction.
// Frames: M, the machine with all axes at zero. Lengths in m; a turn is positive clockwise.
// Failure: InputError for a screw that there is not, or that cannot be turned.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "rig/rig_settings.h"
#include "rig/rotation.h"

namespace abbe::rig {

class TargetScrews {
 public:
  // `corner`: of the target, from which the places of the screws count.
  TargetScrews(const RigSettings& settings, const Eigen::Vector3d& corner);

  void Turn(std::string_view name, double turns);
  // The same turns with the corner of the sweep of another axis.
  void MountAt(const Eigen::Vector3d& corner);
  // The displacement of the target from where it was mounted.
  const Displacement& Seat() const { return seat_; }

 private:
  void Settle();

  std::vector<TargetScrew> screws_;
  std::vector<double> moved_;  // m, the tip of each
  Eigen::Vector3d corner_;
  Displacement seat_;
};

}  // namespace abbe::rig
