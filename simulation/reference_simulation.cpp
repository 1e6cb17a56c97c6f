#include "simulation/reference_simulation.h"

#include <fmt/format.h>

#include <array>
#include <utility>
#include <vector>

#include "failure/failure.h"
#include "geometry/rotation.h"
#include "machine/volumetric_error.h"
#include "simulation/machine_points.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kSetUp = 10e-3;  // rad: how well an instrument is aligned by hand

struct Readings {
  std::vector<Index> axes;  // that the instrument shows
  Matrix3Xd place;          // in M; rows of absent directions are 0
  Eigen::VectorXd sd;       // of each point
};

Readings ReadingsOf(const machine::Chain& chain, double sd, const recording::Recording& recording,
                    const MachinePoints& points) {
  Readings readings{{}, Matrix3Xd::Zero(3, points.count()), VectorXd::Constant(points.count(), sd)};
  for (Index axis = 0; axis < 3; ++axis) {
    const std::string column = fmt::format("ref_{}_mm", "xyz"[axis]);
    if (!recording.Find(column)) continue;
    readings.axes.push_back(axis);
    const double sign = chain.CarriesTarget("XYZ"[axis]) ? -1.0 : 1.0;
    readings.place.row(axis) = sign * ColumnAt(recording, points, column);
  }
  if (readings.axes.empty()) {
    throw InputError(
        fmt::format("{}: has none of ref_x_mm, ref_y_mm, ref_z_mm: nothing says where "
                    "the tool really was",
                    recording.name));
  }
  if (recording.Find("ref_u_um")) readings.sd = ColumnAt(recording, points, "ref_u_um");
  if (!(readings.sd.minCoeff() > 0.0)) {
    throw InputError(
        fmt::format("{}: the reference has no noise; state reference_um in "
                    "[linkage.noise] or ref_u_um above 0",
                    recording.name));
  }
  return readings;
}

// x: place, turn, machine.
class ReferenceResidual : public estimation::Residual {
 public:
  ReferenceResidual(PointsOnMachine points, Readings readings)
      : points_(std::move(points)), readings_(std::move(readings)) {}

  Index Rows() const override {
    return static_cast<Index>(readings_.axes.size()) * points_.points().count();
  }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    std::vector<Matrix3Xd> J;
    const Matrix3Xd p =
        points_.Places(x.tail(points_.parameters()), jacobian == nullptr ? nullptr : &J);
    const Vector3d turn = x.segment<3>(3);
    const Matrix3d R = geometry::ExpRotation<double>(turn);
    const Matrix3d by_turn = geometry::ExpRotationJacobian(turn);
    Index row = 0;
    for (Index i = 0; i < p.cols(); ++i) {
      const Vector3d turned = R * p.col(i);
      const Vector3d left = readings_.place.col(i) - x.head<3>() - turned;
      const Matrix3d J_turn = geometry::Skew(turned) * by_turn;
      for (const Index axis : readings_.axes) {
        values[row] = left[axis] / readings_.sd[i];
        if (jacobian != nullptr) {
          auto out = jacobian->row(row);
          out.head<3>() = -Eigen::RowVector3d::Unit(axis);
          out.segment<3>(3) = J_turn.row(axis);
          out.tail(points_.parameters()) = -R.row(axis) * J[static_cast<std::size_t>(i)];
          out /= readings_.sd[i];
        }
        ++row;
      }
    }
  }

 private:
  PointsOnMachine points_;
  Readings readings_;
};

estimation::ParameterBlock SetUp(const std::string& name, const estimation::PrintUnit& unit,
                                 const std::array<const char*, 3>& entries, double prior_sd) {
  estimation::ParameterBlock block(name, unit, {});
  for (const char* entry : entries) block.entries.push_back({.name = entry, .prior_sd = prior_sd});
  return block;
}

}  // namespace

SimulatedRun SimulateReference(const machine::VolumetricModel& model, const Vector3d& reference,
                               double sd, const recording::Recording& recording) {
  MachinePoints points = ReadMachinePoints(recording);
  Readings readings = ReadingsOf(model.chain(), sd, recording, points);
  SimulatedRun simulated{
      recording.name, "reference", {}, nullptr, estimation::RobustLoss::Huber(kPullsNoMore)};
  simulated.blocks = {
      SetUp("reference_place " + recording.name, {"um", 1e-6}, {"x", "y", "z"},
            estimation::kNoPrior),
      SetUp("reference_turn " + recording.name, {"urad", 1e-6}, {"a", "b", "c"}, kSetUp)};
  // A direction that the instrument does not show has no place.
  for (Index axis = 0; axis < 3; ++axis) {
    const auto& shown = readings.axes;
    simulated.blocks[0].entries[static_cast<std::size_t>(axis)].held =
        std::find(shown.begin(), shown.end(), axis) == shown.end();
  }
  for (auto& block : model.Blocks()) simulated.blocks.push_back(std::move(block));
  simulated.residual = std::make_shared<ReferenceResidual>(
      PointsOnMachine(model, reference, std::move(points)), std::move(readings));
  return simulated;
}

}  // namespace abbe::simulation
