#include "hal/plausible_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "hal/pace.h"

namespace abbe::hal {
namespace {

constexpr double kOtherUnit = 100.0;

}  // namespace

struct PlausibleSource::First {
  const PlausibleChannel* channel = nullptr;
  double count = 0.0, mean = 0.0, squares = 0.0;
  double lowest = 0.0, highest = 0.0;

  void Add(double value) {
    lowest = count == 0.0 ? value : std::min(lowest, value);
    highest = count == 0.0 ? value : std::max(highest, value);
    const double from_mean = value - mean;
    mean += from_mean / ++count;
    squares += from_mean * (value - mean);
  }
  double Deviation() const { return count < 2.0 ? 0.0 : std::sqrt(squares / (count - 1.0)); }
};

PlausibleSource::PlausibleSource(SampleSource& source,
                                 const std::vector<PlausibleChannel>& channels)
    : source_(source), of_channel_(source.channels().size()) {
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
  return set;
}

std::string PlausibleSource::Fault() const {
  const std::string fault = source_.Fault();
  return fault.empty() ? slip_ : fault;
}

// For channels that cannot all be close to zero.
void PlausibleSource::RefuseNothing(const std::vector<First>& first) const {
  const First* any = nullptr;
  for (const First& one : first) {
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
  std::vector<First> first(of_channel_.size());
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
  for (const First& one : first) {
    if (one.channel == nullptr || one.channel->noise <= 0.0 || one.count < 10.0) continue;
    const double deviation = one.Deviation();
    const std::string readings =
        fmt::format("{} in its first {:.0f} readings", one.channel->name, one.count);
    if (one.highest == one.lowest) {
      warnings.push_back(fmt::format(
          "{}: no noise at all, {:.6g} each time: is it frozen, or its scale or unit coarse?",
          readings, one.highest));
    } else if (std::abs(std::log(deviation / one.channel->noise)) > std::log(kOtherUnit)) {
      warnings.push_back(
          fmt::format("{}: a noise of {:.3g}, the machine file says {:.3g}: wrong units?", readings,
                      deviation, one.channel->noise));
    }
  }
  return warnings;
}

}  // namespace abbe::hal
