// A chain of small and large motions whose amounts depend linearly on error parameters: the common
// form of every error model of the linkage.
//
// A motion is a turn about a line or a shift along a direction, both fixed in B while nothing has
// moved; the ball is carried by all of them, from the last to the first:
//
//   p_BT = M1 M2 ... Mk p_BT(0)
//
//   amount of a motion = encoder angle of its joint (if it has one)
//                      + sum over its effects of (x_j - nominal_j) * factor * basis(reading)
//
// where basis is 1, sin or cos of a multiple of an encoder angle, the leaning of a link under
// gravity, or the warmth of the links. So a model is a list of motions and a list of effects, and
// its Jacobian is geometry: a turn moves the ball by (line x arm), a shift along its direction.
//
// Frames: B, the linkage base; T, the ball. Units: m, rad, K. Shapes: `angles` one per joint, `x`
// one per parameter; T is any scalar, also ceres::Jet. Failure: none in the forward functions; the
// builder's functions throw nothing, wrong indices are programming errors. Source:
// docs/theory-relm.md. Validity: the lean under gravity is taken on the nominal chain at the
// encoder angles: what an error of 1 mrad changes in it is 0.1 % of the compliance.
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
  kSine,     // sin(factor * angle)
  kCosine,   // cos(factor * angle)
  kGravity,  // lean of the link after the joint: 1 when horizontal, 0 when upright
  kWarmth,   // factor * (temperature - reference); factor is a length, m
};

struct Effect {
  int motion;
  int parameter;
  Basis basis = Basis::kOne;
  int joint = 0;
  double factor = 1;  // order of a harmonic, length; else a plain factor
};

struct TipDerivatives {
  Eigen::Vector3d tip;       // p_BT, m
  Eigen::Matrix3Xd J_tip_x;  // by the parameters
  Eigen::Matrix3Xd J_tip_q;  // by the encoder angles
};

class MotionChain {
 public:
  // `chain` is the nominal linkage; `down_B` a unit vector.
  MotionChain(SerialChain chain, const Eigen::Vector3d& down_B);

  // Building: motions in the order from base to ball. Return the index.
  int Turn(const Eigen::Vector3d& point, const Eigen::Vector3d& direction);
  int Shift(const Eigen::Vector3d& direction);
  int Joint(int joint);  // the turn of an axis of the chain
  int Parameter(double nominal);
  void Add(const Effect& effect) { effects_.push_back(effect); }

  const SerialChain& chain() const { return chain_; }
  Eigen::Index parameters() const { return static_cast<Eigen::Index>(nominal_.size()); }
  // Whether the link after a joint ever leans sideways about it under gravity.
  bool FeelsGravity(int joint) const;
  // The first link after a joint that stands across its axis, as a unit vector across the axis;
  // zero where there is none.
  Eigen::Vector3d ArmAfter(int joint) const;

  template <typename T>
  Eigen::Vector3<T> Tip(const T* angles, const T& warmth, const T* x) const;

  // `jacobian_x`, 3 x parameters, and `jacobian_q`, 3 x joints, row-major with the given stride
  // between rows; either may be null.
  Eigen::Vector3d Differentiate(const double* angles, double warmth, const double* x,
                                double* jacobian_x, double* jacobian_q) const;

 private:
  template <typename T>
  T BasisOf(const Effect& effect, const T* angles, const T& warmth, const T* lean) const;
  template <typename T>
  void Lean(const T* angles, T* lean) const;

  SerialChain chain_;
  Eigen::Vector3d down_B_;
  std::vector<Eigen::Vector3d> lean_direction_;  // of each joint: axis x arm
  std::vector<Motion> motions_;
  std::vector<Effect> effects_;
  std::vector<double> nominal_;
};

}  // namespace abbe::relm
