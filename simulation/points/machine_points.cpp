#include "simulation/points/machine_points.h"

#include <fmt/format.h>

#include <utility>

#include "machine/volumetric_error.h"
#include "machine/volumetric_jacobian.h"
#include "recording/good_rows.h"
#include "simulation/axes_in_travel.h"
#include "simulation/disturbance.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

}  // namespace

std::optional<Vector3d> HeaderPoint(const recording::Recording& recording, const std::string& key) {
  const auto numbers = recording.HeaderNumbers(key, 3);
  if (!numbers) return std::nullopt;
  return 1e-3 * Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

MachinePoints ReadMachinePoints(const recording::Recording& recording) {
  MachinePoints points;
  points.name = recording.name;
  points.rows = recording::GoodRows(recording);
  points.tool = HeaderPoint(recording, "tool_mm").value_or(Vector3d::Zero());
  points.axes.resize(3, points.rows.size());
  for (Index axis = 0; axis < 3; ++axis) {
    points.axes.row(axis) = ColumnAt(recording, points, fmt::format("{}_mm", "xyz"[axis]));
  }
  return points;
}

Eigen::VectorXd ColumnAt(const recording::Recording& recording, const MachinePoints& points,
                         const std::string& column) {
  const std::vector<double> values = recording::ValuesOf(recording, column, points.rows);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), values.size());
}

PointsOnMachine::PointsOnMachine(machine::VolumetricModel model, const Vector3d& reference,
                                 MachinePoints points)
    : model_(std::move(model)),
      points_(std::move(points)),
      tool_(points_.tool - reference),
      nominal_(3, points_.count()) {
  for (Index i = 0; i < points_.count(); ++i) {
    const Vector3d axes = points_.axes.col(i);
    nominal_.col(i) = machine::NominalToolInWork<double>(model_.chain(), axes, points_.tool);
  }
  // The errors of the end of the travel, not its place.
  points_.axes = AxesInTravel(model_, points_.axes, points_.name, points_.rows);
}

Matrix3Xd PointsOnMachine::Places(const Eigen::VectorXd& machine_parameters,
                                  std::vector<Matrix3Xd>* J_p_x) const {
  machine::VolumetricModel model = model_;
  model.SetParameters(machine_parameters);
  Matrix3Xd places = nominal_;
  if (J_p_x == nullptr) return places + model.Errors(points_.axes, tool_);
  J_p_x->clear();
  for (Index i = 0; i < points_.count(); ++i) {
    auto at = model.Linearize(points_.axes.col(i), tool_);
    places.col(i) += at.error;
    J_p_x->push_back(std::move(at.J_error_parameters));
  }
  return places;
}

Eigen::MatrixXd PointsOnMachine::ByMotions(const Eigen::VectorXd& machine_parameters) const {
  machine::VolumetricModel model = model_;
  model.SetParameters(machine_parameters);
  Eigen::MatrixXd by_motions(3 * points_.count(), kToolStage);
  for (Index i = 0; i < points_.count(); ++i) {
    const Vector3d axes = points_.axes.col(i);
    by_motions.middleRows<3>(3 * i) =
        machine::VolumetricErrorAndJacobian(model.chain(), axes, tool_, model.Motions(axes))
            .J_error_motions;
  }
  return by_motions;
}

}  // namespace abbe::simulation
