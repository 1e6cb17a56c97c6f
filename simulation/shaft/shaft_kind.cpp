// A turning shaft under gap sensors (shaft_run.h).
//
// Each run has its own zeros; the shaft, its axis and the sensors are the same in all runs of a
// campaign. Noise: u_gap_um of the header, else how well the run repeats from turn to turn
// (shaft_noise.h); the sense of the shaft: shaft_sense, else what the sensors see. Failure: that of
// shaft_run.h; InputError where no noise is known.
#include <fmt/format.h>

#include <limits>
#include <memory>
#include <utility>

#include "failure/failure.h"
#include "simulation/kinds.h"
#include "simulation/shaft/shaft_noise.h"
#include "simulation/shaft/shaft_run.h"
#include "simulation/shaft/shaft_simulation.h"

namespace abbe::simulation {
namespace {

using recording::Recording;

constexpr Eigen::Index kMostShaftRows = 6000;  // of one run: more tell no more of causes
constexpr double kLastDigit = 1e-12;           // m

struct ShaftFacts : RunFacts {
  explicit ShaftFacts(RimRepeats of_run) : repeats(std::move(of_run)) {}
  RimRepeats repeats;
};

void NoteSense(const ShaftRun& run, std::vector<std::string>& notes) {
  notes.push_back(fmt::format(
      "{}: by what the sensors see, the angle of the shaft grows {} the count of sensor_deg; where "
      "that is wrong, state shaft_sense = {} in the header",
      run.name, run.sense > 0 ? "with" : "against", -run.sense));
}

void NoteNoise(const ShaftRun& run, const RimRepeats& repeats, std::vector<std::string>& notes) {
  std::string text =
      fmt::format("{}: noise by how well {:.1f} turns repeat:", run.name, repeats.turns);
  for (Eigen::Index i = 0; i < repeats.sd.size(); ++i) {
    text += fmt::format(" sensor_{} {:.3g} um (counts as {:.3g} um, neighbours share it)", i + 1,
                        1e6 * repeats.scatter[i], 1e6 * repeats.sd[i]);
  }
  notes.push_back(text);
}

Eigen::VectorXd NoiseOf(const ShaftRun& run, const RimRepeats& repeats) {
  if (repeats.sd.size() == 0) {
    throw InputError(fmt::format(
        "{}: the noise of the sensors is not known: {:.2f} turns are too few to see how well they "
        "repeat; record {:.0f} or more, or state u_gap_um in the header",
        run.name, repeats.turns, kLeastTurns));
  }
  if (repeats.sd.minCoeff() > kLastDigit) return repeats.sd;
  throw InputError(fmt::format(
      "{}: a sensor repeats to its last digit in every turn; state the noise of a reading as "
      "u_gap_um in the header",
      run.name));
}

class ShaftRuns : public RunKind {
 public:
  std::string_view name() const override { return "shaft"; }
  // No dwell of a head has an angle of a shaft.
  bool Takes(const Recording& head) const override {
    const bool turns = head.Find("shaft_deg") || head.Find("shaft_rad");
    return head.Kind() == name() || (head.Kind() == "dwell" && turns);
  }
  bool NeedsAxes() const override { return false; }

  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel&,
                       const Instruments&, const FactsByRun& known) const override {
    PreparedRuns prepared;
    ShaftRun run = ReadShaftRun(recording);
    auto facts = FactsAs<ShaftFacts>(known, run.name);
    const bool is_new = facts == nullptr;
    if (is_new) facts = std::make_shared<const ShaftFacts>(RepeatsOf(run));
    prepared.facts = facts;
    const RimRepeats& repeats = facts->repeats;
    if (run.sense == 0) {
      SetSense(repeats.sense, run);
      if (is_new && run.rim.sensors > 1) NoteSense(run, prepared.notes);
    }
    if (!(run.sd.minCoeff() > 0.0)) {
      run.sd = NoiseOf(run, repeats);
      if (is_new) NoteNoise(run, repeats, prepared.notes);
    }
    const ShaftRun thinned = Thinned(run, kMostShaftRows);
    prepared.runs.push_back({SimulateShaft(thinned), TraceOf(recording, thinned)});
    return prepared;
  }

  RowRule HeldOut(const Recording& recording) const override {
    return EverySecondPassOrBlock(recording);
  }
  // The sensors are silent in the other rows: the angle of the shaft is needed throughout.
  Recording Part(const Recording& recording, const RowRule& wanted) const override {
    Recording part = recording;
    for (auto& column : part.columns) {
      if (!column.name.starts_with("gap_")) continue;
      for (std::size_t row = 0; row < part.rows(); ++row) {
        if (!wanted(row)) column.values[row] = std::numeric_limits<double>::quiet_NaN();
      }
    }
    return part;
  }

  Recording Plan(Recording path, const Instruments&) const override {
    throw InputError(
        fmt::format("{}: a turning shaft cannot be planned yet; leave the run out", path.name));
  }
};

}  // namespace

const RunKind& ShaftKind() {
  static const ShaftRuns kind;
  return kind;
}

}  // namespace abbe::simulation
