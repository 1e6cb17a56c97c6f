// The linkage of three pivots and two links in closed form: angles to ball, ball to angles.
//
//   const PivotLinkage linkage(0.120, 0.120);
//   const Eigen::Vector3d p_BT = linkage.Tip({q1, q2, q3});
//   const Eigen::Vector3d angles = linkage.Angles(p_BT, {Elbow::kUp});   // throws out of reach
//
// Frames: B, the linkage base: z along pivot 1, pivots 1 and 2 meet in its origin; T, the ball
// centre. q1 turns about z, q2 about the y axis that q1 has turned (q2 > 0 lowers link 1), q3 about
// the same axis at the end of link 1. Link 1 lies along x when q1 = q2 = 0, link 2 along z when q3
// = 0 too.
//
//   p_BT = Rz(q1) Ry(q2) [L1 x + L2 (sin q3 x + cos q3 z)]
//
// Units: m, rad. Shapes: angles [q1 q2 q3], one pose a column in the batch functions.
// Failure: the constructor throws InputError for a length that is not positive and finite; Angles
// throws NumericalError with the distance of the ball. The batch functions do not throw: a pose
// without solution has its Reach and zeros, never NaN. The forward function always succeeds.
// Source: the RELM paper, equations 1 to 3; its inverse is missing from the copy at hand,
// docs/theory-linkage.md derives this one.
// Validity: exact. Tip of single poses is correct to rounding, tips in batch to 3 eps of L1 + L2 in
// each coordinate, whatever the width of the processor's vectors; angles in batch to what that moves
// them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace abbe::relm {

// The elbow stands above or below the line from pivot 2 to the ball, in the vertical plane of both.
enum class Elbow { kUp, kDown };

// One of the four solutions. `reach_over`: q1 points away from the ball and the arm bends back over
// the axis of pivot 1; ball and elbow are at the same places as without it.
struct Branch {
  Elbow elbow = Elbow::kUp;
  bool reach_over = false;
};

enum class Reach {
  kReached,
  kTooFar,    // beyond L1 + L2
  kTooNear,   // within |L1 - L2|, or on pivot 2
  kStraight,  // at the edge of the workspace: both elbows coincide, q2 and q3 not determined
  kOnAxis,    // on the axis of pivot 1: q1 not determined
};

class PivotLinkage {
 public:
  PivotLinkage(double link_1, double link_2);

  double link_1() const { return link_1_; }
  double link_2() const { return link_2_; }

  // p_BT of one pose.
  Eigen::Vector3d Tip(const Eigen::Vector3d& angles) const;
  // d p_BT / d q.
  Eigen::Matrix3d JacobianTipAngles(const Eigen::Vector3d& angles) const;

  // Whether a ball position has angles; a pose nearer to singular than sin(angle) = kSingular
  // counts as singular.
  Reach ReachOf(const Eigen::Vector3d& p_BT) const;
  // The angles of a branch, each in (-pi, pi].
  Eigen::Vector3d Angles(const Eigen::Vector3d& p_BT, const Branch& branch) const;
  // The same without exception: empty when the pose has no angles or is singular.
  std::optional<Eigen::Vector3d> FindAngles(const Eigen::Vector3d& p_BT,
                                            const Branch& branch) const;
  // The branch of a pose, to continue on it.
  Branch BranchOf(const Eigen::Vector3d& angles) const;

  using Poses = Eigen::Ref<const Eigen::Matrix3Xd, 0, Eigen::OuterStride<3>>;
  // Many poses: one column each. Outputs are resized. Returns how many poses were reached.
  void Tips(const Poses& angles, Eigen::Matrix3Xd& tips) const;
  // Columns without angles are zero; `reach` says why.
  Eigen::Index AnglesOf(const Poses& tips, const Branch& branch, Eigen::Matrix3Xd& angles,
                        std::vector<Reach>& reach) const;

  static constexpr double kSingular = 1e-6;

 private:
  double link_1_, link_2_;  // m
};

// Angles of neighbouring poses without jumps of a whole turn: adds multiples of 2 pi to `angles` so
// that each is within pi of `near`.
Eigen::VectorXd Unwrapped(const Eigen::VectorXd& angles, const Eigen::VectorXd& near);

}  // namespace abbe::relm
