// Records a source for a given time: one row for each set of samples, on one clock.
//
//   const auto writer = recording::Writer::Create("circle.csv", RecordHeader(about, channels),
//                                                 RecordColumns(channels));
//   const RecordOutcome outcome = Record(source, clock, *writer, {.rate = 200.0, .seconds = 60.0});
//
// The columns are time_s, the channels in their order, skew_ms (the time between the earliest and
// the latest sample of the row) and flags. The channels "pass", "direction" and "feed_mm_min" of a
// controller are recorded unchanged. While a device does not answer, rows are flagged and the
// recording goes on. Memory does not grow with its length.
// Units: Hz, s; columns as their names say.
// Failure: that of the writer; a device that fails flags rows.
// Source: docs/recordings.md.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "hal/sample_source.h"
#include "recording/recording_file.h"

namespace abbe::hal {

struct RecordAbout {
  std::string machine;
  std::string started;                           // "2026-11-21T09:00:00Z"
  std::map<std::string, std::string> transport;  // DeviceSource::Description by device
};

// "linkage" when the channels have encoders and all three positions, "reference" when they have
// the position of an axis and by a reference instrument, else "dwell".
std::string KindOf(const std::vector<Channel>& channels);

// time_s, the channels, skew_ms, flags.
std::vector<std::string> RecordColumns(const std::vector<Channel>& channels);

// The header of the recording: kind, machine, started, the sources of the channels; "simulated =
// true" where a device identifies itself so.
std::string RecordHeader(const RecordAbout& about, const std::vector<Channel>& channels);

struct RecordOptions {
  double rate = 200.0;                                       // Hz of the clock, readings wanted
  double seconds = std::numeric_limits<double>::infinity();  // of the clock
  bool passes_only = false;                                  // no rows while a channel "pass" is 0
  std::function<bool()> stopped = {};                        // true: end cleanly now
  // After each row: seconds so far, and the fault of the source.
  std::function<void(double elapsed_s, const std::string& fault)> progress = {};
};

struct RecordOutcome {
  std::uint64_t rows = 0;
  std::uint64_t flagged = 0;  // of them
  double mean_skew_s = 0.0;
  double worst_skew_s = 0.0;
  double seconds = 0.0;
  std::string fault;          // of the source at the end, empty when all was well
  std::string worst_channel;  // "pivot_1_rad was bad in 812 rows, last: no reply"
};

// Returns when the time is over, the source has ended or `stopped` returns true, with the file
// closed. Exceptions of the writer pass through; the rows so far are on disk then.
RecordOutcome Record(SampleSource& source, Clock& clock, recording::Writer& writer,
                     const RecordOptions& options);

}  // namespace abbe::hal
