#include "hal/combined_source.h"

#include <algorithm>

namespace abbe::hal {

CombinedSource::CombinedSource(std::vector<std::unique_ptr<SampleSource>> parts, double max_skew_s,
                               Clock& clock)
    : parts_(std::move(parts)), max_skew_s_(max_skew_s), clock_(clock) {
  for (const auto& part : parts_) {
    channels_.insert(channels_.end(), part->channels().begin(), part->channels().end());
  }
}

SampleSet CombinedSource::Read() {
  SampleSet set;
  set.sequence = ++sequence_;
  set.samples.reserve(channels_.size());
  for (const auto& part : parts_) {
    const SampleSet of_part = part->Read();
    set.samples.insert(set.samples.end(), of_part.samples.begin(), of_part.samples.end());
  }
  FinishSet(set, clock_.Now());
  worst_skew_s_ = std::max(worst_skew_s_, set.skew_s);
  if (set.skew_s <= max_skew_s_) return set;
  for (Sample& sample : set.samples) {
    if (sample.quality == Quality::kBad) continue;
    const double age_s = sample.age_s;
    sample = Sample::Bad(Cause::kIncoherent, sample.time_s, sample.sequence);
    sample.age_s = age_s;
  }
  return set;
}

bool CombinedSource::Ended() const {
  return std::any_of(parts_.begin(), parts_.end(), [](const auto& part) { return part->Ended(); });
}

std::string CombinedSource::Fault() const {
  for (const auto& part : parts_) {
    if (std::string fault = part->Fault(); !fault.empty()) return fault;
  }
  return {};
}

OpenedDevices OpenDevices(const DevicesSettings& devices, Clock& clock, Presence presence,
                          const Log& log) {
  OpenedDevices opened;
  std::vector<std::unique_ptr<SampleSource>> parts;
  for (const auto& device : devices.devices) {
    auto source = device->Open(clock, devices.stale, log);
    if (presence == Presence::kRequired) source->Require();
    opened.transport[device->name()] = source->Description();
    if (source->HasCycleStart()) {
      opened.start_cycle = [it = source.get()](int program) { it->StartCycle(program); };
    }
    parts.push_back(std::move(source));
  }
  opened.source = std::make_unique<CombinedSource>(std::move(parts), devices.max_skew, clock);
  return opened;
}

}  // namespace abbe::hal
