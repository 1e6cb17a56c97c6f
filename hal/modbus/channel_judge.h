// Decides whether the registers of one channel are a valid measurement.
//
// A reading that is not younger than the previous one (late, doubled, out of order) is discarded.
// The checks in their order, of which the first that fails gives the cause: the reading is younger
// than `stale`; the status register is ok; the raw number is no sentinel; the value is finite; it
// lies within minimum..maximum; the registers have changed within `stale` (unless the channel may
// freeze). Uses no device and no clock.
// Units: that of the channel; s.
// Failure: none; a reading that is no measurement is a bad sample with its cause.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "hal/modbus/modbus_settings.h"
#include "hal/sample.h"

namespace abbe::hal {

class ChannelJudge {
 public:
  // `stale_s` in seconds. The settings must outlive the judge.
  ChannelJudge(const ChannelSettings& channel, double stale_s);

  // A new reading: the registers of the channel's block, measured at `time_s` and returned at
  // `now_s`; `status` is the word of the status register where the channel has one.
  Sample Judge(std::span<const std::uint16_t> block, std::optional<std::uint16_t> status,
               double time_s, double now_s);

  // No new reading, for this cause.
  Sample Missing(Cause cause, double now_s) const;

 private:
  Cause CauseOf(double raw, std::optional<std::uint16_t> status) const;

  const ChannelSettings* channel_;
  double stale_s_;
  std::array<std::uint16_t, 2> last_words_{};
  double last_s_ = 0.0;     // of the last reading
  double changed_s_ = 0.0;  // of the last reading that differed from the one before
  std::uint64_t sequence_ = 0;
};

}  // namespace abbe::hal
