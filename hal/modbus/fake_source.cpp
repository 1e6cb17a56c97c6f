#include "hal/modbus/fake_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace abbe::hal {
namespace {

// A value beyond every integer type, or beyond the maximum of a float.
double Saturated(const ChannelSettings& channel) {
  if (channel.type != WordType::kFloat32) return std::copysign(1e12, channel.scale);
  return channel.maximum ? *channel.maximum + std::abs(*channel.maximum) + 1.0 : 1e30;
}

}  // namespace

FakeSource::FakeSource(std::vector<ChannelSettings> channels, Truth truth, double stale_s,
                       Clock& clock, const std::string& name)
    : settings_(std::move(channels)),
      truth_(std::move(truth)),
      clock_(clock),
      last_(settings_.size()) {
  for (ChannelSettings& channel : settings_) {
    channel.at = 0;
    channel.status.reset();
    channels_.push_back({channel.name, name});
    judges_.emplace_back(channel, stale_s);
  }
}

const FakeFault* FakeSource::Find(const std::string& channel, double now_s) const {
  const auto acts = [&](const FakeFault& fault) {
    return now_s >= fault.from_s && now_s < fault.to_s &&
           (fault.channel.empty() || fault.channel == channel);
  };
  const auto found = std::find_if(faults_.begin(), faults_.end(), acts);
  return found == faults_.end() ? nullptr : &*found;
}

SampleSet FakeSource::Read() {
  SampleSet set;
  set.sequence = ++sequence_;
  fault_.clear();
  const double now = clock_.Now();
  for (std::size_t i = 0; i < settings_.size(); ++i) set.samples.push_back(ReadChannel(i, now));
  FinishSet(set, now);
  return set;
}

Sample FakeSource::ReadChannel(std::size_t at, double now_s) {
  const ChannelSettings& channel = settings_[at];
  ChannelJudge& judge = judges_[at];
  Reading reading{{}, now_s};
  StoreValue(channel, truth_(channel.name, now_s), reading.words);
  const FakeFault* fault = Find(channel.name, now_s);
  const auto missing = [&](Cause cause, const char* what) {
    fault_ = fmt::format("device \"{}\": {}", channels_[at].device, what);
    return judge.Missing(cause, now_s);
  };
  if (fault != nullptr) {
    switch (fault->kind) {
      case FakeFault::Kind::kLost:
        return missing(Cause::kNoReply, "no answer");
      case FakeFault::Kind::kCorrupt:
        return missing(Cause::kNoReply, "a reply that fails its check");
      case FakeFault::Kind::kRefused:
        return missing(Cause::kRefused, "exception 4 (device failure)");
      case FakeFault::Kind::kLate:
        reading.time_s = now_s - fault->late_s;
        StoreValue(channel, truth_(channel.name, reading.time_s), reading.words);
        break;
      case FakeFault::Kind::kDoubled:
        reading = last_[at];
        break;
      case FakeFault::Kind::kFrozen:
        reading.words = last_[at].words;
        break;
      case FakeFault::Kind::kSaturated:
        StoreValue(channel, Saturated(channel), reading.words);
        break;
      case FakeFault::Kind::kSentinel:
        if (!channel.sentinels.empty()) {
          StoreNumber(channel.sentinels.front(), channel.type, channel.order, reading.words);
        }
        break;
    }
  }
  last_[at] = reading;
  return judge.Judge(reading.words, {}, reading.time_s, now_s);
}

}  // namespace abbe::hal
