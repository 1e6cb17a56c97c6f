// A kind of run: the one place that knows what distinguishes it from the others.
//
//   const RunKind& kind = KindOf(recording);                                   // kinds.h
//   PreparedRuns prepared = kind.Prepare(recording, model, instruments, {});
//
// To fit a run, a kind gives its simulation (simulated_run.h) and its trace (trace.h), in full
// detail for a diagnosis (`Prepare`) or condensed for an error map (`ForMap`). It also knows how to
// take causes out of a recording, which rows to hold out, what a planned run reads and which runs
// could be made next. A kind overrides only what it needs. A new kind is a folder with a RunKind
// and a line in kinds.h; the columns that its recordings must have are a line in
// recording/check.cpp.
// Units: SI; those of recordings as docs/recordings.md has them. Shapes: rows of a run in their
// order.
// Failure: InputError naming the recording, for a run that contradicts itself, the machine file or
// its kind.
// Source: docs/recordings.md lists the kinds.
// Validity: a kind judges a recording by its header and columns.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "estimation/noise_memory.h"
#include "failure/failure.h"
#include "machine/volumetric_model.h"
#include "recording/recording.h"
#include "simulation/correction.h"
#include "simulation/instruments.h"
#include "simulation/planned_paths.h"
#include "simulation/run_source.h"
#include "simulation/simulated_run.h"
#include "simulation/stays.h"
#include "simulation/trace.h"

namespace abbe::simulation {

struct PreparedRun {
  SimulatedRun simulated;
  Trace trace;
  double excess = 1.0;  // noise that `simulated` is whitened with, over the stated one
  // The simulation with another excess; empty: the stated noise is believed.
  std::function<SimulatedRun(double excess)> with_excess = {};
  // What it is whitened with besides, in units of that (remembered_noise.h).
  std::optional<estimation::NoiseMemory> memory = {};

  // Else the stated noise is believed.
  bool EstimatesNoise() const { return static_cast<bool>(with_excess); }
};

// What only a whole run can tell (its noise by repeats, the place of its base). A part of the run
// is prepared with the facts of the whole.
struct RunFacts {
  virtual ~RunFacts() = default;
};
using FactsByRun = std::map<std::string, std::shared_ptr<const RunFacts>>;

// The facts of a run as its kind made them; null: not known yet. InputError where the run of that
// name is of another kind.
template <typename Facts>
std::shared_ptr<const Facts> FactsAs(const FactsByRun& known, const std::string& name) {
  const auto found = known.find(name);
  if (found == known.end()) return nullptr;
  if (auto facts = std::dynamic_pointer_cast<const Facts>(found->second)) return facts;
  throw InputError(name +
                   ": a run of another kind has the same name; name each recording differently");
}

// Rows that were found invalid and left out.
struct InvalidReadings {
  std::string cause;            // "stuck-channel", "outliers"
  std::string object;           // "probe_a", "pivot_1"
  double from = 0.0, to = 0.0;  // s since the recording began
  int count = 0;                // rows
};

struct PreparedRuns {
  std::vector<PreparedRun> runs;               // one, or one for each set-up of a plate
  std::shared_ptr<const RunFacts> facts = {};  // null: none
  std::vector<std::string> notes = {};         // for the report
  std::vector<InvalidReadings> invalid = {};
};

using RowRule = std::function<bool(std::size_t row)>;

// A run that could be made next.
struct NextRun {
  std::string text;                                     // what to do
  recording::Recording path;                            // without readings
  std::shared_ptr<const Instruments> instruments = {};  // null: as they are
  std::function<void(SimulatedRun& run)> start = {};    // sets what the run changes
};

class RunKind {
 public:
  virtual ~RunKind() = default;

  virtual std::string_view name() const = 0;  // "sweep"
  // Judged by header and columns alone.
  virtual bool Takes(const recording::Recording& head) const = 0;
  // A shaft needs none.
  virtual bool NeedsAxes() const { return true; }
  // What it is recorded with, and how that is mounted: runs with both the same need no set-up
  // between them.
  virtual std::string_view Instrument() const { return name(); }
  virtual std::string MountingOf(const recording::Recording& head) const;

  // An error map.
  virtual bool MakesMaps() const { return false; }
  // One, or one for each set-up of a plate.
  virtual std::vector<SimulatedRun> ForMap(const RunSource& source,
                                           const machine::VolumetricModel& model,
                                           const Instruments& instruments) const;

  // A diagnosis. `known`: the facts of the runs prepared before, this one's included. A kind that
  // asks for those of others is prepared after them, one run after the other.
  virtual bool AsksForOthers() const { return false; }
  virtual PreparedRuns Prepare(const recording::Recording& recording,
                               const machine::VolumetricModel& model,
                               const Instruments& instruments, const FactsByRun& known) const = 0;
  // Whether neighbouring rows say that a reading is invalid.
  virtual bool RowsFollowEachOther() const { return true; }
  // Where nothing moves, and has settled.
  virtual Stays StaysIn(const recording::Recording& recording) const { return StaysOf(recording); }
  // Whether readings there show the noise of a channel.
  virtual bool ShowsNoiseAtRest() const { return true; }
  // Whether nothing is moved from the first row to the last.
  virtual bool Stands() const { return false; }
  // Whether its x_mm, y_mm and z_mm are what was read, not where the axes were sent.
  virtual bool ReadsAxes() const { return false; }
  // Refuses runs of this kind that do not belong together.
  virtual void RefuseStrangers(const std::vector<RunSource>& sources,
                               const Instruments& instruments) const;

  // The recording without the causes; unchanged where no map is made of the kind.
  virtual Correction Correct(const recording::Recording& recording,
                             const std::vector<ModelledCause>& causes, const Origin& origin,
                             const Instruments& instruments) const;

  // The rows that are held out; empty: the run takes no part.
  virtual RowRule HeldOut(const recording::Recording& recording) const;
  // The recording with the wanted rows.
  virtual recording::Recording Part(const recording::Recording& recording,
                                    const RowRule& wanted) const;
  // Runs of one group are held out as a whole, every second one, if there are enough of them.
  virtual std::optional<std::string> HeldOutGroup(const recording::Recording& recording) const;

  // A path with the readings of a perfect machine (planned_run.h).
  virtual recording::Recording Plan(recording::Recording path,
                                    const Instruments& instruments) const;
  // Runs to begin with, where nothing needs to be recorded before.
  virtual std::vector<NextRun> FirstRuns(const Instruments& instruments,
                                         const PathAbout& about) const;
  // `recorded`: the runs of this kind so far.
  virtual std::vector<NextRun> NextRuns(const std::vector<const recording::Recording*>& recorded,
                                        const Instruments& instruments,
                                        const PathAbout& about) const;
};

// Every second pass; empty for a run of one pass.
RowRule EverySecondPass(const recording::Recording& recording);
// Every second of 8 blocks in time, so that neighbouring rows stay together.
RowRule EverySecondBlock(const recording::Recording& recording);
// Passes where there are several, else blocks.
RowRule EverySecondPassOrBlock(const recording::Recording& recording);

// For kinds whose recordings may lack times.
void NoteUnknownTimes(const recording::Recording& recording, std::vector<std::string>& notes);

}  // namespace abbe::simulation
