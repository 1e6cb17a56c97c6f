// A hole plate in one or more set-ups (plate_simulation.h), each a run of its own.
#include "simulation/kinds.h"
#include "simulation/points/plate_simulation.h"
#include "simulation/points/point_correction.h"
#include "simulation/points/reference_trace.h"

namespace abbe::simulation {
namespace {

using recording::Recording;

class PlateRuns : public RunKind {
 public:
  std::string_view name() const override { return "plate"; }
  bool Takes(const Recording& head) const override { return head.Kind() == name(); }
  bool ReadsAxes() const override { return true; }

  bool MakesMaps() const override { return true; }
  std::vector<SimulatedRun> ForMap(const RunSource& source, const machine::VolumetricModel& model,
                                   const Instruments& on) const override {
    std::vector<SimulatedRun> runs;
    const Recording recording = source.whole();
    for (const PlateSetup& setup : ReadPlate(recording)) {
      runs.push_back(SimulatePlate(model, on.machine.reference, setup));
      runs.back().times = TraceOf(recording, setup.points).time;
    }
    return runs;
  }

  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel& model,
                       const Instruments& on, const FactsByRun&) const override {
    PreparedRuns prepared;
    for (const PlateSetup& setup : ReadPlate(recording)) {
      prepared.runs.push_back(
          {SimulatePlate(model, on.machine.reference, setup), TraceOf(recording, setup.points)});
    }
    NoteUnknownTimes(recording, prepared.notes);
    NoteUnknownApproach(recording, prepared.notes);
    return prepared;
  }

  Correction Correct(const Recording& recording, const std::vector<ModelledCause>& causes,
                     const Origin& origin, const Instruments& on) const override {
    std::vector<PartOfPoints> parts;
    for (const PlateSetup& setup : ReadPlate(recording)) {
      parts.push_back({setup.points, TraceOf(recording, setup.points), setup.points.rows});
    }
    return CorrectPoints(recording, std::move(parts), causes, origin, on);
  }
};

}  // namespace

const RunKind& PlateKind() {
  static const PlateRuns kind;
  return kind;
}

}  // namespace abbe::simulation
