#include "hal/replay_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "hal/sample_flag.h"

namespace abbe::hal {
namespace {

constexpr std::array<std::string_view, 5> kNoChannels = {"time_s", "pass", "direction",
                                                         "feed_mm_min", "flags"};

}  // namespace

ReplaySource::ReplaySource(recording::Recording recording, Clock& clock)
    : recording_(std::move(recording)), clock_(clock), start_s_(clock.Now()) {
  times_ = recording_.At("time_s");
  flags_ = recording_.Find("flags").value_or(std::span<const double>{});
  for (const recording::Column& column : recording_.columns) {
    if (std::find(kNoChannels.begin(), kNoChannels.end(), column.name) != kNoChannels.end()) {
      continue;
    }
    channels_.push_back({column.name, recording_.name});
    columns_.emplace_back(column.values);
  }
}

SampleSet ReplaySource::Read() {
  SampleSet set;
  if (Ended()) {
    const double now = clock_.Now();
    set.sequence = row_ + 1;
    set.samples.assign(columns_.size(), Sample::Bad(Cause::kStale, now, row_));
    FinishSet(set, now);
    return set;
  }
  const double time = start_s_ + times_[row_] - times_[0];
  clock_.SleepUntil(time);
  const auto flags = flags_.empty() ? 0u : static_cast<std::uint32_t>(std::llround(flags_[row_]));
  const bool has_nan = std::any_of(columns_.begin(), columns_.end(),
                                   [&](const auto& column) { return std::isnan(column[row_]); });
  for (const auto& column : columns_) {
    set.samples.push_back(SampleOf(column[row_], flags, has_nan, time));
  }
  set.sequence = ++row_;
  FinishSet(set, clock_.Now());
  return set;
}

Sample ReplaySource::SampleOf(double value, std::uint32_t flags, bool row_has_nan,
                              double time_s) const {
  constexpr std::uint32_t kUncertain = recording::kInterpolated | recording::kClockJump;
  const std::uint64_t sequence = row_ + 1;
  const std::uint32_t bad = flags & ~kUncertain;
  if (!std::isfinite(value)) {
    return Sample::Bad(bad == 0 ? Cause::kNotANumber : CauseOf(bad), time_s, sequence);
  }
  if (bad != 0 && !row_has_nan) return Sample::Bad(CauseOf(bad), time_s, sequence);
  Sample sample = Sample::Good(value, time_s, sequence);
  if ((flags & kUncertain) != 0) {
    sample.quality = Quality::kUncertain;
    sample.cause = CauseOf(flags & kUncertain);
  }
  return sample;
}

std::string ReplaySource::Fault() const {
  return Ended() ? fmt::format("{}: the recording has ended", recording_.name) : std::string();
}

}  // namespace abbe::hal
