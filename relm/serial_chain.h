// Any serial chain of revolute joints that ends in a ball: product of exponentials.
//
//   const SerialChain arm = SerialChain::FromDenavitHartenberg(rows, X_B0, p_nT);
//   const Eigen::Vector3d p_BT = arm.Tip(angles);
//   const Eigen::Matrix3Xd J_tip_q = arm.JacobianTipAngles(angles);
//
// Frames: B, the linkage base; T, the ball centre. A joint axis is the line of the joint in B with
// all angles at zero; a positive angle turns what follows by the right-hand rule
// about `direction`. With the tip p_BT(0) the chain is complete:
//
//   p_BT = exp([s1] q1) exp([s2] q2) ... exp([sn] qn) p_BT(0)
//
// Units: m, rad. Shapes: one angle per joint, in the order from base to tip; T is any scalar, also
// ceres::Jet.
// Failure: InputError for no joints, a direction of no length, a number that is not finite, or
// segments without an encoder; the forward functions always succeed.
// Source: Murray, Li, Sastry, "A Mathematical Introduction to Robotic Manipulation" (1994), section
// 3.2; segments: the displacement equation of Boelens (2006); Denavit-Hartenberg rows in the
// standard (distal) convention: Rz(q + theta) Tz(d) Tx(a) Rx(alpha).
// Validity: exact.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "geometry/transform.h"

namespace abbe::relm {

struct JointAxis {
  Eigen::Vector3d point;      // m, in B: where the joint sits; link lengths count from it
  Eigen::Vector3d direction;  // in B, a unit vector
};

// One segment of Boelens (2006): S = Rz(theta) Ry(phi), then L along the new z. The value of an
// angle with an encoder is the angle at encoder zero.
enum class SegmentEncoder { kNone, kTheta, kPhi };
struct Segment {
  double length = 0;  // m
  double theta = 0;   // rad
  double phi = 0;     // rad
  SegmentEncoder encoder = SegmentEncoder::kNone;
};

struct DenavitHartenbergRow {
  double theta = 0;    // rad: offset of the angle
  double d = 0;        // m
  double a = 0;        // m
  double alpha = 0;    // rad
  bool fixed = false;  // no joint: stays at theta
};

// R v for the turn by `angle` about the unit vector `axis`.
template <typename T>
Eigen::Vector3<T> Turned(const Eigen::Vector3<T>& v, const Eigen::Vector3d& axis, const T& angle) {
  using std::cos, std::sin;
  const T c = cos(angle), s = sin(angle);
  const Eigen::Vector3<T> w = axis.cast<T>();
  return v * c + w.cross(v) * s + w * (w.dot(v) * (T(1) - c));
}

class SerialChain {
 public:
  SerialChain(std::vector<JointAxis> axes, const Eigen::Vector3d& tip);
  // Joints where a segment has an encoder; the last length ends in the ball.
  static SerialChain FromSegments(const std::vector<Segment>& segments);
  // `X_B0` is the base of the first row, `p_nT` the ball in the frame of the last.
  static SerialChain FromDenavitHartenberg(const std::vector<DenavitHartenbergRow>& rows,
                                           const geometry::Transform<double>& X_B0 = {},
                                           const Eigen::Vector3d& p_nT = Eigen::Vector3d::Zero());

  Eigen::Index joints() const { return axes_.size(); }
  const std::vector<JointAxis>& axes() const { return axes_; }
  const Eigen::Vector3d& tip() const { return tip_; }  // p_BT at zero angles

  // From joint `joint` (from 0) to the next one, or from the last to the ball, at zero angles.
  Eigen::Vector3d Link(Eigen::Index joint) const;
  double Reach() const;  // m: no ball farther than this from the first joint can be reached

  // p_BT; joints() angles.
  template <typename T>
  Eigen::Vector3<T> Tip(const T* angles) const {
    Eigen::Vector3<T> p = tip_.cast<T>();
    for (std::size_t i = axes_.size(); i-- > 0;) {
      const Eigen::Vector3<T> point = axes_[i].point.cast<T>();
      p = point + Turned<T>(p - point, axes_[i].direction, angles[i]);
    }
    return p;
  }
  // p_BT.
  Eigen::Vector3d Tip(const Eigen::VectorXd& angles) const { return Tip(angles.data()); }

  // d p_BT / d q, 3 x joints.
  Eigen::Matrix3Xd JacobianTipAngles(const Eigen::VectorXd& angles) const;

 private:
  std::vector<JointAxis> axes_;
  Eigen::Vector3d tip_;
};

// The displacement equation of Boelens (2006) as written, P = S0 (R0 + S1 (R1 + ... )), encoder
// angles included in theta and phi.
template <typename T>
struct SegmentConstants {
  T length, theta, phi;
};
template <typename T>
Eigen::Vector3<T> SegmentTip(const std::vector<SegmentConstants<T>>& segments) {
  Eigen::Vector3<T> p = Eigen::Vector3<T>::Zero();
  for (std::size_t q = segments.size(); q-- > 0;) {
    p.z() += segments[q].length;
    p = geometry::RotationZ<T>(segments[q].theta) * (geometry::RotationY<T>(segments[q].phi) * p);
  }
  return p;
}

}  // namespace abbe::relm
