#include "hal/recorder.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "hal/pace.h"
#include "hal/sample_row.h"

namespace abbe::hal {
namespace {

std::vector<std::size_t> ColumnsOf(const SampleSource& source) {
  std::vector<std::size_t> columns(source.channels().size());
  std::iota(columns.begin(), columns.end(), std::size_t{1});  // behind time_s
  return columns;
}

// The index of the channel "pass".
std::optional<std::size_t> PassOf(const SampleSource& source) {
  const auto pass = std::ranges::find(source.channels(), "pass", &Channel::name);
  if (pass == source.channels().end()) return {};
  return static_cast<std::size_t>(pass - source.channels().begin());
}

}  // namespace

RecordOutcome Record(SampleSource& source, Clock& clock, recording::Writer& writer,
                     const RecordOptions& options) {
  SampleRow samples(source.channels(), ColumnsOf(source));
  std::vector<double> row(source.channels().size() + 3);
  RecordOutcome outcome;
  const auto pass = options.passes_only ? PassOf(source) : std::nullopt;
  const double start_s = clock.Now();
  Pace pace(clock, options.rate);
  double row_s = -1.0, skews_s = 0.0;
  bool jumped = false;
  try {
    while (!(options.stopped && options.stopped()) && !source.Ended()) {
      jumped = !pace.Await() || jumped;
      if (pace.now_s() - start_s >= options.seconds) break;
      const SampleSet set = source.Read();
      pace.Done();
      const double set_s = set.time_s - start_s;
      if (!(set_s > row_s)) continue;  // the same set again is no new row
      if (pass && set.samples[*pass].value == 0.0) continue;
      row[0] = row_s = set_s;
      row.back() = samples.Fill(set, row, std::exchange(jumped, false));
      row[row.size() - 2] = 1e3 * set.skew_s;
      skews_s += set.skew_s;
      writer.Append(row);
      ++outcome.rows;
      if (options.progress) options.progress(set_s, source.Fault());
    }
  } catch (...) {
    writer.Close();
    throw;
  }
  writer.Close();
  outcome.flagged = samples.flagged();
  outcome.worst_skew_s = samples.worst_skew_s();
  outcome.mean_skew_s = outcome.rows == 0 ? 0.0 : skews_s / outcome.rows;
  outcome.seconds = clock.Now() - start_s;
  outcome.fault = source.Fault();
  outcome.worst_channel = samples.WorstChannel();
  return outcome;
}

}  // namespace abbe::hal
