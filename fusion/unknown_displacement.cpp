#include "fusion/unknown_displacement.h"

#include <algorithm>

namespace abbe::fusion {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd UnknownDisplacement(const machine::VolumetricModel& model, const Eigen::Vector3d& p_TQ,
                             double displacement) {
  constexpr Index kPoints = 11;  // along each travel
  double longest = 0.0;
  for (const auto& travel : model.travels()) {
    longest = std::max(longest, travel.last - travel.first);
  }
  VectorXd variance = VectorXd::Constant(model.ParameterCount(), 1.0 / (longest * longest));
  Index first = 0;
  for (int error = 0; error < machine::kAxes * machine::kMotions; ++error) {
    const int motion = error % machine::kMotions;
    const Index size = model.Function(error / machine::kMotions, motion).size();
    if (motion < machine::kAxes) variance.segment(first, size).setOnes();
    first += size;
  }
  double squares = 0.0;
  for (Index point = 0; point < kPoints * kPoints * kPoints; ++point) {
    Eigen::Vector3d at;
    Index place = point;
    for (Index axis = 0; axis < 3; ++axis, place /= kPoints) {
      const auto& travel = model.travels()[axis];
      const auto part = static_cast<double>(place % kPoints) / (kPoints - 1);
      at[axis] = travel.first + part * (travel.last - travel.first);
    }
    const Eigen::Matrix3Xd J = model.Linearize(at, p_TQ).J_error_parameters;
    squares += (J * variance.asDiagonal()).cwiseProduct(J).sum() / 3.0;
  }
  const double mean = squares / (kPoints * kPoints * kPoints);
  return (displacement * displacement / mean) * MatrixXd(variance.asDiagonal());
}

}  // namespace abbe::fusion
