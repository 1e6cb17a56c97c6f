#include "relm/serial_chain.h"

#include <fmt/format.h>

#include <utility>

#include "failure/failure.h"
#include "geometry/rotation.h"

namespace abbe::relm {
namespace {

using Eigen::Vector3d;
using geometry::Transform;

Transform<double> Move(const Eigen::Matrix3d& R) { return {R, Vector3d::Zero()}; }
Transform<double> Move(const Vector3d& p) { return {Eigen::Matrix3d::Identity(), p}; }

}  // namespace

SerialChain::SerialChain(std::vector<JointAxis> axes, const Vector3d& tip)
    : axes_(std::move(axes)), tip_(tip) {
  if (axes_.empty()) {
    throw InputError("linkage: the chain has no joint; give at least one axis with an encoder");
  }
  if (!tip_.allFinite()) throw InputError("linkage: the position of the ball is not finite");
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    JointAxis& axis = axes_[i];
    const double length = axis.direction.norm();
    if (!axis.point.allFinite() || !std::isfinite(length) || length == 0) {
      throw InputError(fmt::format(
          "linkage: joint {} needs a finite point and a direction that is not zero", i + 1));
    }
    axis.direction /= length;
  }
}

SerialChain SerialChain::FromSegments(const std::vector<Segment>& segments) {
  std::vector<JointAxis> axes;
  Transform<double> X;
  for (const Segment& segment : segments) {
    if (segment.encoder == SegmentEncoder::kTheta) axes.push_back({X.p, X.R.col(2)});
    X = X * Move(geometry::RotationZ(segment.theta));
    if (segment.encoder == SegmentEncoder::kPhi) axes.push_back({X.p, X.R.col(1)});
    X = X * Move(geometry::RotationY(segment.phi)) * Move(Vector3d(0, 0, segment.length));
  }
  return SerialChain(std::move(axes), X.p);
}

SerialChain SerialChain::FromDenavitHartenberg(const std::vector<DenavitHartenbergRow>& rows,
                                               const Transform<double>& X_B0,
                                               const Vector3d& p_nT) {
  std::vector<JointAxis> axes;
  Transform<double> X = X_B0;
  for (const DenavitHartenbergRow& row : rows) {
    if (!row.fixed) axes.push_back({X.p, X.R.col(2)});
    X = X * Move(geometry::RotationZ(row.theta)) * Move(Vector3d(row.a, 0, row.d)) *
        Move(geometry::RotationX(row.alpha));
  }
  return SerialChain(std::move(axes), X * p_nT);
}

Vector3d SerialChain::Link(Eigen::Index joint) const {
  return (joint + 1 < std::ssize(axes_) ? axes_[joint + 1].point : tip_) - axes_[joint].point;
}

double SerialChain::Reach() const {
  double reach = 0;
  for (Eigen::Index i = 0; i < joints(); ++i) reach += Link(i).norm();
  return reach;
}

Eigen::Matrix3Xd SerialChain::JacobianTipAngles(const Eigen::VectorXd& angles) const {
  // From the tip inwards: a turn by q_i moves the tip by axis x arm; the joints before i rotate
  // that derivative.
  Eigen::Matrix3Xd J(3, joints());
  Vector3d p = tip_;
  for (Eigen::Index i = joints(); i-- > 0;) {
    const auto& [point, direction] = axes_[i];
    p = point + Turned<double>(p - point, direction, angles[i]);
    J.col(i) = direction.cross(p - point);
    for (Eigen::Index j = i + 1; j < joints(); ++j) {
      J.col(j) = Turned<double>(J.col(j), direction, angles[i]);
    }
  }
  return J;
}

}  // namespace abbe::relm
