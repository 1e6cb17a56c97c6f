#include "relm/motion_chain.h"

#include <algorithm>
#include <utility>

namespace abbe::relm {
namespace {

using Eigen::Vector3d;

constexpr double kLeastArm = 1e-9;  // m: an arm shorter than this across an axis is no arm

std::size_t At(Eigen::Index index) { return index; }

}  // namespace

MotionChain::MotionChain(SerialChain chain, const Vector3d& down_B)
    : chain_(std::move(chain)), down_B_(down_B) {
  for (int joint = 0; joint < joints(); ++joint) {
    lean_direction_.push_back(chain_.axes()[At(joint)].direction.cross(ArmAfter(joint)));
  }
}

int MotionChain::Turn(const Vector3d& point, const Vector3d& direction) {
  motions_.push_back({MotionKind::kTurn, point, direction});
  return static_cast<int>(motions_.size()) - 1;
}

int MotionChain::Shift(const Vector3d& direction) {
  motions_.push_back({MotionKind::kShift, Vector3d::Zero(), direction});
  return static_cast<int>(motions_.size()) - 1;
}

int MotionChain::Joint(int joint) {
  const JointAxis& axis = chain_.axes()[At(joint)];
  motions_.push_back({MotionKind::kTurn, axis.point, axis.direction, joint});
  return static_cast<int>(motions_.size()) - 1;
}

int MotionChain::Parameter(double rest) {
  rest_.push_back(rest);
  return static_cast<int>(rest_.size()) - 1;
}

int MotionChain::Weigh(int carrier, const Vector3d& point) {
  weights_.push_back({carrier, point});
  return static_cast<int>(weights_.size()) - 1;
}

void MotionChain::Add(const Effect& effect) {
  effects_.push_back(effect);
  if (effect.basis != Basis::kWeight) orders_ = std::max(orders_, effect.order + 1);
  gravity_ = gravity_ || effect.basis == Basis::kGravity;
}

Vector3d MotionChain::ArmAfter(int joint) const {
  const Vector3d& axis = chain_.axes()[At(joint)].direction;
  for (Eigen::Index link = joint; link < joints(); ++link) {
    const Vector3d along = chain_.Link(link);
    const Vector3d across = along - axis * axis.dot(along);
    if (across.norm() > kLeastArm) return across.normalized();
  }
  return Vector3d::Zero();
}

bool MotionChain::FeelsGravity(int joint) const {
  const bool turned_by_others = joint > 0;
  const Vector3d& axis = chain_.axes()[At(joint)].direction;
  return lean_direction_[At(joint)] != Vector3d::Zero() &&
         (turned_by_others || axis.cross(down_B_).norm() > 1e-9);
}

SerialChain MotionChain::Moved(const double* x) const {
  std::vector<double> amounts(motions_.size(), 0.0);
  for (const Effect& effect : effects_) {
    if (effect.basis != Basis::kOne) continue;
    amounts[At(effect.motion)] +=
        (x[effect.parameter] - rest_[At(effect.parameter)]) * effect.factor;
  }
  std::vector<JointAxis> axes = chain_.axes();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (std::size_t k = 0; k < motions_.size(); ++k) {
    const Motion& motion = motions_[k];
    if (motion.joint >= 0) {
      axes[At(motion.joint)] = {X * motion.point, X.linear() * motion.direction};
    }
    if (motion.kind == MotionKind::kShift) {
      X.translate(amounts[k] * motion.direction);
    } else {
      X.translate(motion.point);
      X.rotate(Eigen::AngleAxisd(amounts[k], motion.direction));
      X.translate(-motion.point);
    }
  }
  return {axes, X * chain_.tip()};
}

void MotionChain::Amounts(const double* angles, double warmth, const double* x,
                          Workspace& w) const {
  const std::size_t harmonics = lean_direction_.size() * At(orders_);
  w.sines.resize(harmonics);
  w.cosines.resize(harmonics);
  w.leans.resize(lean_direction_.size());
  w.levers.resize(lean_direction_.size() * weights_.size());
  w.bases.resize(effects_.size());
  w.amounts.assign(motions_.size(), 0.0);
  Harmonics(angles, w.sines.data(), w.cosines.data());
  Leans(angles, w.leans.data());
  Levers(angles, w.levers.data());
  for (std::size_t k = 0; k < motions_.size(); ++k) {
    if (motions_[k].joint >= 0) w.amounts[k] = angles[motions_[k].joint];
  }
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    const Effect& effect = effects_[e];
    w.bases[e] =
        BasisOf(effect, w.sines.data(), w.cosines.data(), w.leans.data(), w.levers.data(), warmth);
    w.amounts[At(effect.motion)] +=
        (x[effect.parameter] - rest_[At(effect.parameter)]) * w.bases[e];
  }
}

void MotionChain::LeanSlopes(const double* angles, Workspace& w) const {
  w.lean_slopes.setZero(joints(), joints());
  if (!gravity_) return;
  Eigen::Matrix3Xd slopes(3, joints());  // of the direction of gravity in the frame of the link
  Vector3d down = down_B_;
  for (Eigen::Index i = 0; i < joints(); ++i) {
    const Vector3d& axis = chain_.axes()[At(i)].direction;
    down = Turned<double>(down, axis, -angles[i]);
    for (Eigen::Index j = 0; j < i; ++j) {
      slopes.col(j) = Turned<double>(slopes.col(j), axis, -angles[i]);
    }
    slopes.col(i) = -axis.cross(down);
    w.lean_slopes.row(i).head(i + 1) = lean_direction_[At(i)].transpose() * slopes.leftCols(i + 1);
  }
}

// A turn of a joint nearer to the base, or of the own one, is that of gravity the other way; one
// between the joint and the weight moves the weight.
void MotionChain::LeverSlopes(const double* angles, Workspace& w) const {
  if (weights_.empty()) return;
  const Pose<double> pose = PoseAt(angles);
  w.lever_slopes.setZero(w.levers.size(), joints());
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < joints(); ++i) {
    const Vector3d axis = pose.directions.col(i);
    for (std::size_t k = 0; k < weights_.size(); ++k, ++row) {
      const Vector3d weight = pose.weights.col(k);
      for (Eigen::Index j = 0; j <= weights_[k].carrier; ++j) {
        const Vector3d turned = pose.directions.col(j);
        const Vector3d arm = weight - pose.points.col(i);
        w.lever_slopes(row, j) =
            j <= i ? axis.dot(arm.cross(down_B_.cross(turned)))
                   : axis.dot(turned.cross(weight - pose.points.col(j)).cross(down_B_));
      }
    }
  }
}

double MotionChain::BasisSlope(const Effect& effect, Eigen::Index joint, const Workspace& w) const {
  if (effect.basis == Basis::kGravity) {
    return effect.factor * w.lean_slopes(effect.joint, joint);
  }
  if (effect.basis == Basis::kWeight) {
    return effect.factor * w.lever_slopes(LeverOf(effect), joint);
  }
  if (effect.joint != joint) return 0;
  const std::size_t harmonic = At(effect.joint * orders_ + effect.order);
  switch (effect.basis) {
    case Basis::kSine:
      return effect.factor * effect.order * w.cosines[harmonic];
    case Basis::kCosine:
      return -effect.factor * effect.order * w.sines[harmonic];
    default:
      return 0;
  }
}

Vector3d MotionChain::Differentiate(const double* angles, double warmth, const double* x,
                                    double* J_tip_x, double* J_tip_q, Workspace& w) const {
  Amounts(angles, warmth, x, w);
  // From the base outwards: each line as moved by the motions before it.
  const Eigen::Index count = motions_.size();
  w.lines.resize(3, count);
  w.points.resize(3, count);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();
  for (Eigen::Index k = 0; k < count; ++k) {
    const Motion& motion = motions_[At(k)];
    const double amount = w.amounts[At(k)];
    w.lines.col(k).noalias() = R * motion.direction;
    if (motion.kind == MotionKind::kShift) {
      p += w.lines.col(k) * amount;
      continue;
    }
    const Vector3d point = R * motion.point + p;
    w.points.col(k) = point;
    if (amount == 0) continue;
    R = (R * Eigen::AngleAxisd(amount, motion.direction).toRotationMatrix()).eval();
    p = point - R * motion.point;
  }
  const Vector3d tip = R * chain_.tip() + p;

  // The derivative of the tip by each amount replaces its line.
  for (Eigen::Index k = 0; k < count; ++k) {
    if (motions_[At(k)].kind == MotionKind::kTurn) {
      w.lines.col(k) = Vector3d(w.lines.col(k)).cross(tip - w.points.col(k));
    }
  }
  using Rows = Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>;
  if (J_tip_x != nullptr) {
    Rows J(J_tip_x, 3, parameters());
    J.setZero();
    for (std::size_t e = 0; e < effects_.size(); ++e) {
      J.col(effects_[e].parameter) += w.lines.col(effects_[e].motion) * w.bases[e];
    }
  }
  if (J_tip_q != nullptr) {
    Rows J(J_tip_q, 3, joints());
    J.setZero();
    for (Eigen::Index k = 0; k < count; ++k) {
      if (motions_[At(k)].joint >= 0) J.col(motions_[At(k)].joint) += w.lines.col(k);
    }
    LeanSlopes(angles, w);
    LeverSlopes(angles, w);
    for (const Effect& effect : effects_) {
      const double deviation = x[effect.parameter] - rest_[At(effect.parameter)];
      for (Eigen::Index joint = 0; joint < joints(); ++joint) {
        J.col(joint) += w.lines.col(effect.motion) * (deviation * BasisSlope(effect, joint, w));
      }
    }
  }
  return tip;
}

}  // namespace abbe::relm
