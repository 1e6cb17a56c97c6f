#include "relm/weights.h"

#include <Eigen/Geometry>

namespace abbe::relm {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kOnTheLine = 1e-6;  // m

Vector3d Foot(const JointAxis& axis, const Vector3d& point) {
  return axis.point + axis.direction * axis.direction.dot(point - axis.point);
}

// The point of `axis` nearest to the line `other`; the axes are not parallel.
Vector3d NearestTo(const JointAxis& other, const JointAxis& axis) {
  const Vector3d across = axis.direction.cross(other.direction);
  const double along =
      (other.point - axis.point).cross(other.direction).dot(across) / across.squaredNorm();
  return axis.point + along * axis.direction;
}

// Where the link before each axis meets it, from the ball inwards; of the first axis the point
// where the link after it begins.
std::vector<Vector3d> Meetings(const SerialChain& chain) {
  const auto& axes = chain.axes();
  std::vector<Vector3d> meets(axes.size());
  Vector3d next = Foot(axes.back(), chain.tip());  // where the link after the axis begins
  for (std::size_t i = axes.size(); i-- > 1;) {
    const JointAxis &own = axes[i], &before = axes[i - 1];
    const bool parallel = own.direction.cross(before.direction).norm() < kParallel;
    meets[i] = parallel ? next : NearestTo(before, own);
    next = Foot(before, meets[i]);
  }
  meets[0] = next;
  return meets;
}

}  // namespace

std::vector<Weight> WeightsBeyond(const SerialChain& chain, Index joint) {
  const std::vector<Vector3d> meets = Meetings(chain);
  const Index last = chain.joints() - 1;
  std::vector<Weight> weights;
  if (joint + 1 < last) {
    weights.push_back({"own", joint, meets[joint + 1]});
  }
  if (joint < last) weights.push_back({"wrist", last - 1, meets.back()});
  weights.push_back({"ball", last, chain.tip()});
  // What joints between move does not keep on the line, unless it is on theirs as well.
  const auto on_lines = [&](const Weight& weight) {
    for (Index i = joint; i <= weight.carrier; ++i) {
      const JointAxis& axis = chain.axes()[i];
      if ((weight.point - Foot(axis, weight.point)).norm() > kOnTheLine) return false;
    }
    return true;
  };
  std::erase_if(weights, on_lines);
  return weights;
}

}  // namespace abbe::relm
