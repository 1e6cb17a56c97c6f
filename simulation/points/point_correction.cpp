// Correction of runs whose rows are points of the machine (machine_points.h): of the positions of
// the axes.
#include "machine/volumetric_jacobian.h"
#include "simulation/correction_steps.h"
#include "simulation/points/machine_points.h"
#include "simulation/points/plate_simulation.h"
#include "simulation/points/reference_run.h"
#include "simulation/points/reference_trace.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using recording::Recording;

struct PartOfRecording {
  MachinePoints points;  // where the trace has its rows
  Trace trace;
  std::vector<std::size_t> rows;  // of the recording: all that belong to them
};

std::vector<PartOfRecording> PartsOfRecording(const Recording& recording,
                                              const machine::Machine& machine) {
  std::vector<PartOfRecording> parts;
  if (recording.Kind() == "reference") {
    const ReferenceRun rows = ReadReferenceRun(WithAllAxes(recording, machine.travels));
    const ReferenceRun stays = MeansOfStays(rows);
    parts.push_back({stays.points, TraceOf(recording, stays), rows.points.rows});
  } else if (recording.Kind() == "plate") {
    for (const PlateSetup& setup : ReadPlate(recording)) {
      parts.push_back({setup.points, TraceOf(recording, setup.points), setup.points.rows});
    }
  } else {
    const MachinePoints points = ReadMachinePoints(recording);
    parts.push_back({points, TraceOf(recording, points), points.rows});
  }
  return parts;
}

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

Correction CorrectPoints(const Recording& recording, const std::vector<ModelledCause>& causes,
                         const Origin& origin, const CorrectedMachine& on) {
  Correction corrected{recording, {}};
  std::vector<Moved> axes;
  for (Index axis = 0; axis < 3; ++axis) {
    axes.emplace_back(corrected.recording, PositionColumn(axis), corrected.changes.positions);
  }
  for (PartOfRecording& part : PartsOfRecording(recording, on.machine)) {
    const Matrix3Xd steps = StepsOf(part.points, SumsOf(part.trace, causes, origin), on.machine);
    std::size_t point = 0;
    for (const std::size_t row : part.rows) {
      while (point + 1 < part.points.rows.size() && part.points.rows[point + 1] <= row) ++point;
      for (Index axis = 0; axis < 3; ++axis) {
        axes[static_cast<std::size_t>(axis)].By(row, steps(axis, static_cast<Index>(point)));
      }
    }
  }
  return corrected;
}

}  // namespace abbe::simulation
