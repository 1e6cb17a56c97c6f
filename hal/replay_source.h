// A recording as if it were measured again.
//
// The clock sets the pace: a row is returned when the clock reaches its time (the first at once).
// A SteadyClock(1) replays in real time, SteadyClock(20) twenty times faster, and a HandClock as
// fast as possible. No row is left out, however slow the reader.
//
// The flags of the recording are those of the source that measured: NaN is bad, with the cause that
// the flag of its row gives. A flagged row without a NaN does not name the channel, so all of it is
// bad (or uncertain, when the flag is only "interpolated" or "clock jump").
// Units: those of the columns.
// Failure: InputError for a recording without time_s.
#pragma once

#include <span>
#include <vector>

#include "hal/clock.h"
#include "hal/sample_source.h"
#include "recording/recording.h"

namespace abbe::hal {

class ReplaySource : public SampleSource {
 public:
  // Every column but time_s, pass, direction, feed_mm_min and flags is a channel. InputError
  // without a column time_s. `clock` must outlive the source.
  ReplaySource(recording::Recording recording, Clock& clock);
  ReplaySource(const ReplaySource&) = delete;
  ReplaySource& operator=(const ReplaySource&) = delete;

  const std::vector<Channel>& channels() const override { return channels_; }
  // Waits for the next row; after the last one all samples are bad (stale).
  SampleSet Read() override;
  // After the last row.
  bool Ended() const override { return row_ >= times_.size(); }
  // That the recording has ended.
  std::string Fault() const override;

 private:
  Sample SampleOf(double value, std::uint32_t flags, bool row_has_nan, double time_s) const;

  recording::Recording recording_;
  Clock& clock_;
  double start_s_;
  std::span<const double> times_;
  std::span<const double> flags_;                 // empty when the recording has none
  std::vector<std::span<const double>> columns_;  // in the order of channels_
  std::vector<Channel> channels_;
  std::size_t row_ = 0;
};

}  // namespace abbe::hal
