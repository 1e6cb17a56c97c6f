#include "fusion/map_doubt.h"

#include <Eigen/QR>

#include "fusion/unknown_displacement.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The parameters of `model` whose functions come nearest to those of another: the same ones where
// both have the same knots.
VectorXd ParametersOn(const machine::VolumetricModel& model,
                      const machine::VolumetricModel& other) {
  constexpr Index kStations = 4;  // for each parameter
  VectorXd parameters = model.Parameters();
  if (other.ParameterCount() == model.ParameterCount()) return other.Parameters();
  parameters.tail<3>() = other.Parameters().tail<3>();
  Index first = 0;
  for (int error = 0; error < machine::kAxes * machine::kMotions; ++error) {
    const int axis = error / machine::kMotions, motion = error % machine::kMotions;
    const auto& function = model.Function(axis, motion);
    const Index size = function.size();
    if (size == 0) continue;
    const auto& travel = model.travels()[axis];
    const VectorXd x = VectorXd::LinSpaced(kStations * size, travel.first, travel.last);
    Eigen::MatrixXd rows(x.size(), size);
    VectorXd values(x.size()), gradient(size);
    for (Index i = 0; i < x.size(); ++i) {
      function.Evaluate(x[i], nullptr, gradient.data());
      rows.row(i) = gradient.transpose();
      values[i] = other.Function(axis, motion).Evaluate(x[i]);
    }
    const VectorXd fit = rows.completeOrthogonalDecomposition().solve(values);
    parameters.segment(first, size) = fit;
    first += size;
  }
  return parameters;
}

}  // namespace

void AddDoubt(const Doubt& doubt, const machine::VolumetricModel& found,
              const Eigen::Vector3d& tool, Eigen::MatrixXd& covariance) {
  if (doubt.other != nullptr) {
    const VectorXd change = found.Parameters() - ParametersOn(found, doubt.other->model());
    covariance += change * change.transpose();
  }
  if (doubt.displacement > 0.0) {
    covariance += UnknownDisplacement(found, tool, doubt.displacement);
  }
}

}  // namespace abbe::fusion
