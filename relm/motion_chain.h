// A chain of small and large motions whose amounts depend linearly on error parameters: the common
// form of every error model of the linkage.
//
// A motion is a turn about a line or a shift along a direction, both given in B for amounts of
// zero. The ball is moved by all of them, from the last to the first:
//
//   p_BT = M1 M2 ... Mk p_BT(0)
//
//   amount of a motion = encoder angle of its joint (if it has one)
//                      + sum over its effects of (x_j - rest_j) * factor * basis(reading)
//
// where basis is 1, sin or cos of a multiple of an encoder angle, the lean of an arm under gravity,
// the lever of a weight, or the warmth of the links. A model is a list of motions and of effects;
// its Jacobian is geometry: a turn moves the ball by (line x arm), a shift along its direction.
//
// Frames: B, the linkage base; T, the ball.
// Units: m, rad, K. Shapes: `angles` one per joint, `x` one per parameter; T is any scalar, also
// ceres::Jet.
// Failure: none; a wrong index is a programming error.
// Source: docs/theory-linkage.md.
// Validity: lean and levers under gravity are taken on the nominal chain at the encoder angles: an
// error of 1 mrad changes them by 0.1 %.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "relm/serial_chain.h"

namespace abbe::relm {

enum class MotionKind { kTurn, kShift };

struct Motion {
  MotionKind kind;
  Eigen::Vector3d point;      // m, in B: on the line of a turn
  Eigen::Vector3d direction;  // in B, a unit vector
  int joint = -1;             // whose encoder angle turns it; -1: none
};

enum class Basis {
  kOne,
  kSine,     // sin(order * angle)
  kCosine,   // cos(order * angle)
  kGravity,  // lean of the arm after the joint: +-1 when horizontal, 0 when upright
  kWeight,   // lever of a weight about the joint, m: torque over weight
  kWarmth,   // temperature - reference, K
};

struct Effect {
  int motion;
  int parameter = 0;  // filled in by ModelBuilder
  Basis basis = Basis::kOne;
  int joint = 0;      // of the angle, or of the arm
  int order = 0;      // of a harmonic, from 1; of a weight, what Weigh gave
  double factor = 1;  // e.g. the length that grows with warmth
};

class MotionChain {
 public:
  // `chain` is the nominal linkage, `down_B` the unit vector along gravity.
  MotionChain(SerialChain chain, const Eigen::Vector3d& down_B);

  // Building, in the order from base to ball. Each returns the index of what it adds.
  int Turn(const Eigen::Vector3d& point, const Eigen::Vector3d& direction);
  // Along `direction`, a unit vector in B.
  int Shift(const Eigen::Vector3d& direction);
  int Joint(int joint);        // the turn of an axis of the chain; each joint once
  int Parameter(double rest);  // `rest`: the value at which its effects vanish
  // A point, in B at zero angles, that joint `carrier` is the last to move, pulled down.
  int Weigh(int carrier, const Eigen::Vector3d& point);
  // To the amount of its motion.
  void Add(const Effect& effect);

  const SerialChain& chain() const { return chain_; }
  Eigen::Index joints() const { return chain_.joints(); }
  Eigen::Index parameters() const { return rest_.size(); }

  // The direction of the first link after a joint that is not parallel to its axis: a unit vector
  // across the axis, in B at zero angles; zero without such a link.
  Eigen::Vector3d ArmAfter(int joint) const;
  // Whether that arm ever leans about the joint under gravity.
  bool FeelsGravity(int joint) const;

  template <typename T>
  Eigen::Vector3<T> Tip(const T* angles, const T& warmth, const T* x) const;

  // The lines of the joints and the tip at zero angles, moved by the effects that are constant: the
  // geometry alone.
  SerialChain Moved(const double* x) const;

  // Memory for Differentiate, to be kept over many poses.
  struct Workspace {
    std::vector<double> sines, cosines, leans, levers, bases, amounts;
    Eigen::Matrix3Xd lines, points;  // of the motions, in B, as they stand in the pose
    Eigen::MatrixXd lean_slopes;     // d lean_i / d q_j
    Eigen::MatrixXd lever_slopes;    // d lever / d q_j, a row for each lever
  };
  // The tip and its derivatives: `J_tip_x` 3 x parameters and `J_tip_q` 3 x joints, both row after
  // row; either may be null.
  Eigen::Vector3d Differentiate(const double* angles, double warmth, const double* x,
                                double* J_tip_x, double* J_tip_q, Workspace& workspace) const;

 private:
  // Sine and cosine of the multiples 0 ... orders_ - 1 of each angle, at joint * orders_ + order.
  template <typename T>
  void Harmonics(const T* angles, T* sines, T* cosines) const;
  template <typename T>
  void Leans(const T* angles, T* leans) const;
  // The axes and the weights as they stand in a pose.
  template <typename T>
  struct Pose {
    Eigen::Matrix3X<T> directions, points, weights;
  };
  template <typename T>
  Pose<T> PoseAt(const T* angles) const;
  // The lever of weight k about joint i stands at i * weights_.size() + k.
  template <typename T>
  void Levers(const T* angles, T* levers) const;
  std::size_t LeverOf(const Effect& effect) const {
    return effect.joint * weights_.size() + effect.order;
  }
  template <typename T>
  T BasisOf(const Effect& effect, const T* sines, const T* cosines, const T* leans, const T* levers,
            const T& warmth) const;
  double BasisSlope(const Effect& effect, Eigen::Index joint, const Workspace& workspace) const;
  void LeanSlopes(const double* angles, Workspace& workspace) const;
  void LeverSlopes(const double* angles, Workspace& workspace) const;
  void Amounts(const double* angles, double warmth, const double* x, Workspace& workspace) const;

  SerialChain chain_;
  Eigen::Vector3d down_B_;
  std::vector<Eigen::Vector3d> lean_direction_;  // of each joint: axis x arm
  std::vector<Motion> motions_;
  std::vector<Effect> effects_;
  std::vector<double> rest_;
  struct Hanging {
    int carrier;
    Eigen::Vector3d point;
  };
  std::vector<Hanging> weights_;
  int orders_ = 1;
  bool gravity_ = false;
};

template <typename T>
void MotionChain::Harmonics(const T* angles, T* sines, T* cosines) const {
  using std::cos, std::sin;
  for (Eigen::Index joint = 0; joint < joints(); ++joint) {
    T* const s = sines + joint * orders_;
    T* const c = cosines + joint * orders_;
    s[0] = T(0);
    c[0] = T(1);
    if (orders_ == 1) continue;
    s[1] = sin(angles[joint]);
    c[1] = cos(angles[joint]);
    for (int n = 2; n < orders_; ++n) {  // angle addition: loses n roundings, n is small
      s[n] = s[n - 1] * c[1] + c[n - 1] * s[1];
      c[n] = c[n - 1] * c[1] - s[n - 1] * s[1];
    }
  }
}

// lean_i = (axis_i x arm_i) . g_i, where g_i is the direction of gravity in the frame of link i.
template <typename T>
void MotionChain::Leans(const T* angles, T* leans) const {
  if (!gravity_) return;
  Eigen::Vector3<T> down = down_B_.cast<T>();
  for (std::size_t i = 0; i < lean_direction_.size(); ++i) {
    down = Turned<T>(down, chain_.axes()[i].direction, T(-angles[i]));
    leans[i] = down.dot(lean_direction_[i].cast<T>());
  }
}

template <typename T>
MotionChain::Pose<T> MotionChain::PoseAt(const T* angles) const {
  Pose<T> pose{Eigen::Matrix3X<T>(3, joints()), Eigen::Matrix3X<T>(3, joints()),
               Eigen::Matrix3X<T>(3, std::ssize(weights_))};
  Eigen::Matrix3<T> R = Eigen::Matrix3<T>::Identity();
  Eigen::Vector3<T> p = Eigen::Vector3<T>::Zero();
  for (Eigen::Index i = 0; i < joints(); ++i) {
    const JointAxis& axis = chain_.axes()[i];
    const Eigen::Vector3<T> point = axis.point.cast<T>();
    pose.directions.col(i) = R * axis.direction.cast<T>();
    pose.points.col(i) = R * point + p;
    Eigen::Matrix3<T> turn;
    for (Eigen::Index k = 0; k < 3; ++k) {
      turn.col(k) = Turned<T>(Eigen::Vector3<T>::Unit(k), axis.direction, angles[i]);
    }
    R = (R * turn).eval();
    p = pose.points.col(i) - R * point;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (weights_[k].carrier != i) continue;
      pose.weights.col(k) = R * weights_[k].point.cast<T>() + p;
    }
  }
  return pose;
}

template <typename T>
void MotionChain::Levers(const T* angles, T* levers) const {
  if (weights_.empty()) return;
  const Pose<T> pose = PoseAt(angles);
  const Eigen::Vector3<T> down = down_B_.cast<T>();
  for (Eigen::Index i = 0; i < joints(); ++i) {
    for (Eigen::Index k = 0; k < pose.weights.cols(); ++k) {
      const Eigen::Vector3<T> arm = pose.weights.col(k) - pose.points.col(i);
      *levers++ = pose.directions.col(i).dot(arm.cross(down));
    }
  }
}

template <typename T>
T MotionChain::BasisOf(const Effect& effect, const T* sines, const T* cosines, const T* leans,
                       const T* levers, const T& warmth) const {
  const int harmonic = effect.joint * orders_ + effect.order;
  switch (effect.basis) {
    case Basis::kSine:
      return sines[harmonic] * effect.factor;
    case Basis::kCosine:
      return cosines[harmonic] * effect.factor;
    case Basis::kGravity:
      return leans[effect.joint] * effect.factor;
    case Basis::kWeight:
      return levers[LeverOf(effect)] * effect.factor;
    case Basis::kWarmth:
      return warmth * effect.factor;
    default:
      return T(effect.factor);
  }
}

template <typename T>
Eigen::Vector3<T> MotionChain::Tip(const T* angles, const T& warmth, const T* x) const {
  const std::size_t joints = lean_direction_.size();
  const std::size_t harmonics = joints * orders_;
  std::vector<T> values(2 * harmonics + joints * (1 + weights_.size()), T(0));
  T* const sines = values.data();
  T* const cosines = sines + harmonics;
  T* const leans = cosines + harmonics;
  T* const levers = leans + joints;
  Harmonics(angles, sines, cosines);
  Leans(angles, leans);
  Levers(angles, levers);
  std::vector<T> amounts(motions_.size(), T(0));
  for (std::size_t k = 0; k < motions_.size(); ++k) {
    if (motions_[k].joint >= 0) amounts[k] = angles[motions_[k].joint];
  }
  for (const Effect& effect : effects_) {
    const std::size_t j = effect.parameter;
    amounts[effect.motion] +=
        (x[j] - T(rest_[j])) * BasisOf(effect, sines, cosines, leans, levers, warmth);
  }
  Eigen::Vector3<T> p = chain_.tip().cast<T>();
  for (std::size_t k = motions_.size(); k-- > 0;) {
    const Motion& motion = motions_[k];
    if (motion.kind == MotionKind::kShift) {
      p += motion.direction.cast<T>() * amounts[k];
    } else {
      const Eigen::Vector3<T> point = motion.point.cast<T>();
      p = point + Turned<T>(p - point, motion.direction, amounts[k]);
    }
  }
  return p;
}

}  // namespace abbe::relm
