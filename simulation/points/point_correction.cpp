#include "simulation/points/point_correction.h"

#include "machine/volumetric_jacobian.h"
#include "simulation/correction_steps.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using recording::Recording;

// By how much the axes really stood elsewhere, [x y z] of each point.
Matrix3Xd StepsOf(const MachinePoints& points, const Sums& sums, const machine::Machine& machine) {
  Matrix3Xd steps(3, points.count());
  for (Index i = 0; i < points.count(); ++i) {
    steps.col(i) = machine::VolumetricErrorAndJacobian(machine.chain, Vector3d(points.axes.col(i)),
                                                       points.tool - machine.reference, {})
                       .J_error_motions *
                   sums.machine.col(i).head<kToolStage>();
  }
  return machine.chain.ToolSenses().asDiagonal() * steps;
}

}  // namespace

Correction CorrectPoints(const Recording& recording, std::vector<PartOfPoints> parts,
                         const std::vector<ModelledCause>& causes, const Origin& origin,
                         const Instruments& on) {
  Correction corrected{recording, {}};
  std::vector<Moved> axes;
  for (Index axis = 0; axis < 3; ++axis) {
    axes.emplace_back(corrected.recording, PositionColumn(axis), corrected.changes.positions);
  }
  for (PartOfPoints& part : parts) {
    const Matrix3Xd steps = StepsOf(part.points, SumsOf(part.trace, causes, origin), on.machine);
    std::size_t point = 0;
    for (const std::size_t row : part.rows) {
      while (point + 1 < part.points.rows.size() && part.points.rows[point + 1] <= row) ++point;
      for (Index axis = 0; axis < 3; ++axis) {
        axes[axis].By(row, steps(axis, point));
      }
    }
  }
  return corrected;
}

}  // namespace abbe::simulation
