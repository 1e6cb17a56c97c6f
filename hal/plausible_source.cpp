#include "hal/plausible_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "hal/pace.h"

namespace abbe::hal {
namespace {

constexpr double kOtherUnit = 100.0;
constexpr double kGrown = 10.0;   // of the stated noise
constexpr double kFewest = 10.0;  // readings that show a noise
constexpr int kSetsOfStay = 20;   // that are judged together: their deviation is known to 16 %
constexpr int kSettling = -20;    // sets after a move

}  // namespace

void PlausibleSource::Few::Add(double value) {
  lowest = count == 0.0 ? value : std::min(lowest, value);
  highest = count == 0.0 ? value : std::max(highest, value);
  const double from_mean = value - mean;
  mean += from_mean / ++count;
  squares += from_mean * (value - mean);
}

double PlausibleSource::Few::Deviation() const {
  return count < 2.0 ? 0.0 : std::sqrt(squares / (count - 1.0));
}

PlausibleSource::PlausibleSource(SampleSource& source,
                                 const std::vector<PlausibleChannel>& channels)
    : source_(source),
      of_channel_(source.channels().size()),
      stay_(source.channels().size()),
      noisy_(source.channels().size()) {
  for (std::size_t i = 0; i < of_channel_.size(); ++i) {
    const auto found =
        std::ranges::find(channels, source.channels()[i].name, &PlausibleChannel::name);
    if (found != channels.end()) of_channel_[i] = *found;
  }
}

std::string PlausibleSource::RefusalOf(const PlausibleChannel& channel, double value) const {
  return fmt::format(
      "{} reads {:.6g}, and {}: check `order`, `type`, `scale` and `at` of this channel in the "
      "machine file",
      channel.name, value, channel.because);
}

SampleSet PlausibleSource::Read() {
  SampleSet set = source_.Read();
  slip_.clear();
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    Sample& sample = set.samples[i];
    const auto& channel = of_channel_[i];
    if (!channel || !sample.good() || channel->good.Holds(sample.value)) continue;
    if (slip_.empty() && !channel->possible.Holds(sample.value)) {
      slip_ = RefusalOf(*channel, sample.value);
    }
    const Sample read = sample;
    sample = Sample::Bad(Cause::kOutOfRange, read.time_s, read.sequence);
    sample.age_s = read.age_s;
    sample.within_s = read.within_s;
  }
  WatchStay(set);
  return set;
}

void PlausibleSource::WatchStay(const SampleSet& set) {
  bool knows_place = false, moved = false;
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    const auto& channel = of_channel_[i];
    if (!channel || !set.samples[i].good()) continue;
    const Few& before = stay_[i];
    const double value = set.samples[i].value;
    knows_place = knows_place || channel->still > 0.0;
    moved = moved || (channel->still > 0.0 && before.count > 0.0 &&
                      std::abs(value - before.mean) > channel->still);
  }
  if (!knows_place || moved) {
    std::ranges::fill(stay_, Few{});
    in_stay_ = kSettling;
  }
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    if (set.samples[i].good()) stay_[i].Add(set.samples[i].value);
  }
  ++in_stay_;
  if (in_stay_ != 0 && in_stay_ < kSetsOfStay) return;
  if (in_stay_ == kSetsOfStay) JudgeStay();
  std::ranges::fill(stay_, Few{});
  in_stay_ = 0;
}

void PlausibleSource::JudgeStay() {
  for (std::size_t i = 0; i < stay_.size(); ++i) {
    const auto& channel = of_channel_[i];
    const double deviation = stay_[i].Deviation();
    if (!channel || channel->noise <= 0.0 || noisy_[i] != 0 || stay_[i].count < kFewest ||
        deviation < kGrown * channel->noise) {
      continue;
    }
    noisy_[i] = 1;
    warnings_.push_back(fmt::format(
        "{}: a noise of {:.3g} while the machine stood, the machine file says {:.3g}: look for "
        "vibration, a loose probe or cable, interference",
        channel->name, deviation, channel->noise));
  }
}

std::vector<std::string> PlausibleSource::TakeWarnings() { return std::exchange(warnings_, {}); }

std::string PlausibleSource::Fault() const {
  const std::string fault = source_.Fault();
  return fault.empty() ? slip_ : fault;
}

// For channels that cannot all be close to zero.
void PlausibleSource::RefuseNothing(const std::vector<Few>& first) const {
  const Few* any = nullptr;
  for (const Few& one : first) {
    if (one.channel == nullptr || one.channel->least <= 0.0) continue;
    if (one.count == 0.0 || one.highest >= one.channel->least) return;
    any = &one;
  }
  if (any == nullptr) return;
  throw InputError(fmt::format(
      "{} and the like read {:.3g} at most, close to zero, and {}: an amplifier that is off, or "
      "wrong units; check them and `scale` and `at` of these channels in the machine file",
      any->channel->name, any->highest, any->channel->because));
}

std::vector<std::string> PlausibleSource::Require(int count, Clock& clock, double rate) {
  std::vector<Few> first(of_channel_.size());
  Pace pace(clock, rate);
  for (int i = 0; i < count && !Ended(); ++i) {
    pace.Await();
    const SampleSet set = Read();
    if (!slip_.empty()) throw InputError(slip_);
    for (std::size_t c = 0; c < first.size(); ++c) {
      if (of_channel_[c]) first[c].channel = &*of_channel_[c];
      if (set.samples[c].good()) first[c].Add(set.samples[c].value);
    }
  }
  if (count > 1) RefuseNothing(first);
  std::vector<std::string> warnings;
  for (const Few& one : first) {
    if (one.channel == nullptr || one.channel->noise <= 0.0 || one.count < kFewest) continue;
    const double deviation = one.Deviation();
    const std::string readings =
        fmt::format("{} in its first {:.0f} readings", one.channel->name, one.count);
    if (one.highest == one.lowest) {
      warnings.push_back(fmt::format(
          "{}: no noise at all, {:.6g} each time: is it frozen, or its scale or unit coarse?",
          readings, one.highest));
    } else if (std::abs(std::log(deviation / one.channel->noise)) > std::log(kOtherUnit)) {
      noisy_[&one - first.data()] = 1;
      warnings.push_back(
          fmt::format("{}: a noise of {:.3g}, the machine file says {:.3g}: wrong units?", readings,
                      deviation, one.channel->noise));
    }
  }
  return warnings;
}

}  // namespace abbe::hal
