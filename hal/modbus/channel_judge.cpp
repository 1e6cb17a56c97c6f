#include "hal/modbus/channel_judge.h"

#include <algorithm>
#include <cmath>

namespace abbe::hal {

ChannelJudge::ChannelJudge(const ChannelSettings& channel, double stale_s)
    : channel_(&channel), stale_s_(stale_s) {}

Sample ChannelJudge::Judge(std::span<const std::uint16_t> block,
                           std::optional<std::uint16_t> status, double time_s, double now_s) {
  if (sequence_ > 0 && time_s <= last_s_) return Missing(Cause::kStale, now_s);
  last_s_ = time_s;
  std::array<std::uint16_t, 2> words{};
  std::copy_n(block.begin() + channel_->at, WordCount(channel_->type), words.begin());
  if (sequence_ == 0 || words != last_words_) {
    last_words_ = words;
    changed_s_ = time_s;
  }
  ++sequence_;
  const double raw = NumberOf(words, channel_->type, channel_->order);
  Cause cause = now_s - time_s > stale_s_ ? Cause::kStale : CauseOf(raw, status);
  if (cause == Cause::kNone && !channel_->may_freeze && time_s - changed_s_ > stale_s_) {
    cause = Cause::kFrozen;
  }
  return cause == Cause::kNone ? Sample::Good(ValueOf(*channel_, raw), time_s, sequence_)
                               : Sample::Bad(cause, time_s, sequence_);
}

Sample ChannelJudge::Missing(Cause cause, double now_s) const {
  return Sample::Bad(cause, now_s, sequence_);
}

Cause ChannelJudge::CauseOf(double raw, std::optional<std::uint16_t> status) const {
  if (channel_->status) {
    const auto& ok = channel_->status->ok;
    const auto masked = static_cast<std::uint16_t>(status.value_or(0) & channel_->status->mask);
    if (!status || std::find(ok.begin(), ok.end(), masked) == ok.end()) return Cause::kSensorFault;
  }
  const auto& sentinels = channel_->sentinels;
  if (std::find(sentinels.begin(), sentinels.end(), raw) != sentinels.end()) {
    return Cause::kSentinel;
  }
  const double value = ValueOf(*channel_, raw);
  if (!std::isfinite(value)) return Cause::kNotANumber;
  if (value < channel_->minimum.value_or(value) || value > channel_->maximum.value_or(value)) {
    return Cause::kOutOfRange;
  }
  return Cause::kNone;
}

}  // namespace abbe::hal
