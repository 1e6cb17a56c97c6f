// Runs with a reference instrument: positioning tests (ISO 230-2) and any other way of the axes
// under a grid encoder or a tracker.
//
// Axes that a test does not record stand still (reference_run.h); in a diagnosis a target counts
// with the mean of its readings. Noise: what the recording states, else in a diagnosis how well a
// positioning test repeats (reference_noise.h), else [linkage.noise] of the machine file. A run
// without times has its readings a second apart. Failure: that of reference_run.h; InputError where
// no noise is known.
#include <fmt/format.h>

#include <memory>

#include "failure/failure.h"
#include "simulation/kinds.h"
#include "simulation/points/point_correction.h"
#include "simulation/points/reference_noise.h"
#include "simulation/points/reference_simulation.h"
#include "simulation/points/reference_trace.h"

namespace abbe::simulation {
namespace {

using recording::Recording;

constexpr Eigen::Index kMostReferenceRows = 4000;  // of one run: more tell no more of causes

struct ReferenceFacts : RunFacts {
  explicit ReferenceFacts(const Eigen::Vector3d& noise) : sd(noise) {}
  Eigen::Vector3d sd;  // m, by how well the run repeats
};

bool StatesNoise(const ReferenceRun& run) { return run.sd.minCoeff() > 0.0; }

std::string NoiseText(const ReferenceRun& run, const RepeatNoise& noise) {
  std::string text =
      fmt::format("{}: noise of the reference by how well its readings repeat:", run.points.name);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!run.shown[axis]) continue;
    text += fmt::format(" ref_{} {:.3g} um", "xyz"[axis], 1e6 * noise.sd[axis]);
  }
  return text + fmt::format(", {} degrees of freedom", noise.freedom);
}

ReferenceRun ReadRun(const Recording& recording, const Instruments& on) {
  return ReadReferenceRun(WithAllAxes(recording, on.machine.travels));
}

// The noise of a run that states none.
Eigen::Vector3d NoiseOf(const ReferenceRun& run, const Instruments& on, const FactsByRun& known,
                        PreparedRuns& prepared) {
  if (const auto facts = FactsAs<ReferenceFacts>(known, run.points.name)) return facts->sd;
  if (const auto noise = NoiseOfRepeats(run)) {
    prepared.notes.push_back(NoiseText(run, *noise));
    prepared.facts = std::make_shared<const ReferenceFacts>(noise->sd);
    return noise->sd;
  }
  if (on.linkage) return Eigen::Vector3d::Constant(on.linkage->noise.reference);
  throw InputError(fmt::format(
      "{}: the noise of the reference is not known: it states none, and too few readings repeat "
      "to tell; state u_reference_um in its header",
      run.points.name));
}

class ReferenceRuns : public RunKind {
 public:
  std::string_view name() const override { return "reference"; }
  bool Takes(const Recording& head) const override { return head.Kind() == name(); }

  bool MakesMaps() const override { return true; }
  std::vector<SimulatedRun> ForMap(const RunSource& source, const machine::VolumetricModel& model,
                                   const Instruments& on) const override {
    ReferenceRun run = ReadRun(source.whole(), on);
    if (!StatesNoise(run)) {
      PreparedRuns of_repeats;
      SetNoise(on.linkage ? Eigen::Vector3d::Constant(on.linkage->noise.reference)
                          : NoiseOf(run, on, {}, of_repeats),
               run);
    }
    return {SimulateReference(model, on.machine.reference, run)};
  }

  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel& model,
                       const Instruments& on, const FactsByRun& known) const override {
    PreparedRuns prepared;
    ReferenceRun run = Thinned(MeansOfStays(ReadRun(recording, on)), kMostReferenceRows);
    if (!StatesNoise(run)) SetNoise(NoiseOf(run, on, known, prepared), run);
    NoteUnknownTimes(recording, prepared.notes);
    prepared.runs.push_back(
        {SimulateReference(model, on.machine.reference, run), TraceOf(recording, run)});
    return prepared;
  }

  Correction Correct(const Recording& recording, const std::vector<ModelledCause>& causes,
                     const Origin& origin, const Instruments& on) const override {
    const ReferenceRun rows = ReadRun(recording, on);
    const ReferenceRun stays = MeansOfStays(rows);
    return CorrectPoints(recording, {{stays.points, TraceOf(recording, stays), rows.points.rows}},
                         causes, origin, on);
  }

  RowRule HeldOut(const Recording& recording) const override {
    return EverySecondPassOrBlock(recording);
  }
};

}  // namespace

const RunKind& ReferenceKind() {
  static const ReferenceRuns kind;
  return kind;
}

}  // namespace abbe::simulation
