// Several devices read as one: one set of samples, complete and coherent or bad.
//
// The parts are read one after another. A set whose good samples lie further apart in time than
// `max_skew` is no measurement of one state of the machine: all its samples become bad
// (incoherent).
// Units: s of the clock.
// Failure: none from Read; DeviceError from OpenDevices as said.
// Validity: skew is that of the stamps; a device that stamps wrongly hides it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "hal/device_settings.h"
#include "hal/sample_source.h"

namespace abbe::hal {

class CombinedSource : public SampleSource {
 public:
  // All parts are on `clock`, which must outlive the source; `max_skew_s` in seconds of it.
  CombinedSource(std::vector<std::unique_ptr<SampleSource>> parts, double max_skew_s, Clock& clock);

  const std::vector<Channel>& channels() const override { return channels_; }
  // All parts, one after the other.
  SampleSet Read() override;
  bool Ended() const override;         // as soon as one part has ended
  std::string Fault() const override;  // of the first part that has one

  double worst_skew_s() const { return worst_skew_s_; }  // measured so far

 private:
  std::vector<std::unique_ptr<SampleSource>> parts_;
  double max_skew_s_;
  Clock& clock_;
  std::vector<Channel> channels_;
  std::uint64_t sequence_ = 0;
  double worst_skew_s_ = 0.0;
};

// The devices of a machine file as one source.
struct OpenedDevices {
  std::unique_ptr<SampleSource> source;
  // DeviceSource::StartCycle of the last device that has one; empty when none has.
  std::function<void(int program)> start_cycle;
  std::map<std::string, std::string> transport;  // DeviceSource::Description by device
};

enum class Presence { kRequired, kAwaited };

// With kRequired every device must answer now, else DeviceError; with kAwaited those that do not
// answer yet give bad samples until they do. DeviceError in any case for a host name that does not
// resolve.
OpenedDevices OpenDevices(const DevicesSettings& devices, Clock& clock, Presence presence,
                          const Log& log = {});

}  // namespace abbe::hal
