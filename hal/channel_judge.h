// Decides whether the registers of one channel are a measurement.
//
// A reading that is not younger than the one before it (late, doubled, out of order) is discarded.
// The order of the questions, the first that fails gives the cause: is the reading younger than
// `stale`; does the status register approve; is the raw number a sentinel; is it a number; is the
// value within minimum..maximum; have the registers changed within `stale` (unless the channel may
// freeze). Knows no device and no clock.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "hal/device_settings.h"
#include "hal/sample.h"

namespace abbe::hal {

class ChannelJudge {
 public:
  // `stale_s` in seconds. The settings must outlive the judge.
  ChannelJudge(const ChannelSettings& channel, double stale_s);

  // A new reading: the registers of the channel's block, measured at `time_s` and handed over at
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
