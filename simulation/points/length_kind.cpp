// Lengths along a line through the volume: step gauges, laser interferometers
// (length_simulation.h).
#include <fmt/format.h>

#include <numeric>

#include "simulation/kinds.h"
#include "simulation/points/length_simulation.h"
#include "simulation/points/point_correction.h"
#include "simulation/points/reference_trace.h"

namespace abbe::simulation {
namespace {

using recording::Recording;

class LengthRuns : public RunKind {
 public:
  std::string_view name() const override { return "length"; }
  bool Takes(const Recording& head) const override { return head.Kind() == name(); }

  // Aligned anew for each axis.
  std::string MountingOf(const Recording& head) const override {
    return head.HeaderText("axis").value_or("");
  }

  bool MakesMaps() const override { return true; }
  std::vector<SimulatedRun> ForMap(const RunSource& source, const machine::VolumetricModel& model,
                                   const Instruments& on) const override {
    return {SimulateLengths(model, on.machine.reference, source.whole())};
  }

  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel& model,
                       const Instruments& on, const FactsByRun&) const override {
    PreparedRuns prepared{{{SimulateLengths(model, on.machine.reference, recording),
                            TraceOf(recording, ReadMachinePoints(recording))}}};
    NoteUnknownTimes(recording, prepared.notes);
    NoteUnknownApproach(recording, prepared.notes);
    return prepared;
  }

  Correction Correct(const Recording& recording, const std::vector<ModelledCause>& causes,
                     const Origin& origin, const Instruments& on) const override {
    const MachinePoints points = ReadMachinePoints(recording);
    return CorrectPoints(recording, {{points, TraceOf(recording, points), points.rows}}, causes,
                         origin, on);
  }

  // Along each axis, through the middle of the volume.
  std::vector<NextRun> NextRuns(const std::vector<const Recording*>&, const Instruments& on,
                                const PathAbout& about) const override {
    Eigen::Vector3d middle;
    for (int axis = 0; axis < machine::kAxes; ++axis) {
      const machine::Travel& travel = on.machine.travels[axis];
      middle[axis] = std::midpoint(travel.first, travel.last);
    }
    std::vector<NextRun> runs;
    for (const char axis : {'X', 'Y', 'Z'}) {
      const machine::Travel& travel = on.machine.travels[axis - 'X'];
      if (travel.first == travel.last) continue;
      runs.push_back({fmt::format("measure a length along {} (interferometer or step gauge)", axis),
                      LengthPath(axis, middle, travel, about)});
    }
    return runs;
  }
};

}  // namespace

const RunKind& LengthKind() {
  static const LengthRuns kind;
  return kind;
}

}  // namespace abbe::simulation
