// Records an axis sweep: reads a source at a steady rate and writes every row of every pass, motion
// included, as it comes.
//
//   const std::string header = SweepHeader(plan, about, source.channels());
//   const auto writer =
//       recording::Writer::Create("sweep_X.csv", header, SweepColumns(source.channels()));
//   const SweepOutcome outcome = RecordSweep(source, plan, clock, *writer, options);
//
// The sweep is followed by the channel of the swept axis ("x_mm"); where `prompt` is set, the
// operator confirms that the axis stands; its position must then be within `window` of the station,
// or the operator is asked again. Without a channel of the axis the position is that of the plan.
// The recording begins with the first pass, so no row has direction 0. Axes without a channel are
// written as `rest`.
//
// A sample that is not good is written as NaN (an uncertain one as its number) and its cause is a
// bit of `flags`. While a device does not answer, rows are flagged and the sweep goes on. Memory
// does not grow with its length.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "hal/sample_source.h"
#include "hal/sweep_plan.h"
#include "recording/recording_file.h"

namespace abbe::hal {

struct SweepProgress {
  std::size_t visits_done;
  std::size_t visits_total;
  double elapsed_s;
  std::string fault;  // of the source, empty when there is none
};

struct SweepOptions {
  double rate = 200.0;                                      // Hz of the clock, readings wanted
  std::array<double, 3> rest{};                             // m, x y z
  std::function<void(const SweepProgress&)> progress = {};  // at each visit done and each new fault
  std::function<bool()> stopped = {};                       // true: end cleanly now
  std::function<bool(const Visit&)> prompt = {};  // returns when the axis stands; false: end now
  // Why a visit that was prompted does not begin: it is prompted again.
  std::function<void(const std::string& why)> refused = {};
};

enum class SweepEnd {
  kComplete,     // the last visit of the plan is done
  kStopped,      // by `stopped` or `prompt`
  kSourceEnded,  // the replayed recording has no more rows
  kStandstill,   // the machine had moved, then stood for `idle` before its last visit
};
std::string_view NameOf(SweepEnd end);

struct SweepOutcome {
  SweepEnd end = SweepEnd::kStopped;
  std::uint64_t rows = 0;
  std::uint64_t flagged = 0;  // of them
  double worst_skew_s = 0.0;
  double seconds = 0.0;
  std::string fault;          // of the source at the end, empty when all was well
  std::string worst_channel;  // "probe_a_um was bad in 812 rows, last: frozen"; empty when none was
  std::vector<Visit> lacking;  // visits without a good reading during half of their dwell
};

// time_s, x_mm, y_mm, z_mm, pass, direction, feed_mm_min, the other channels in their order, flags.
std::vector<std::string> SweepColumns(const std::vector<Channel>& channels);

struct SweepAbout {
  std::string machine;
  std::string started;        // "2026-11-21T09:00:00Z"
  std::string source = {};    // of the readings of a device without an entry in `transport`
  std::string mounting = {};  // which set-up of head and target this is; empty: not stated
  std::string more = {};      // further lines of TOML
  std::map<std::string, std::string> transport = {};  // DeviceSource::Description by device
};

// The header of the recording: kind, machine, axis, started, the sources of the channels, the plan;
// "simulated = true" where a device identifies itself so.
std::string SweepHeader(const SweepPlan& plan, const SweepAbout& about,
                        const std::vector<Channel>& channels);

// Returns when the sweep has ended, with the file closed. DeviceError when the axis did not move
// for `plan.idle` from the start; InputError when neither a position channel nor `prompt` is there.
// What the writer throws passes through. In every case the rows so far are on disk.
SweepOutcome RecordSweep(SampleSource& source, const SweepPlan& plan, Clock& clock,
                         recording::Writer& writer, const SweepOptions& options = {});

}  // namespace abbe::hal
