// The interface between devices and recorders.
//
// Implementations: DeviceSource (a device, transport.h), ReplaySource (a recording), FakeSource
// (faults on demand), CombinedSource (several of these as one). One contract holds for all, and
// one test checks it:
//
//   - channels() never changes; Read() gives one sample for each of them, in that order.
//   - Read() returns within the deadline of its devices. It never throws for a fault of a device
//     but reports it by the quality and the cause of the samples, and by Fault().
//   - Frozen, saturated, sentinel, stale, lost or corrupt is never good, and carries NaN.
//   - Sequence numbers and times never decrease; a reading that is returned twice is good once.
//   - When the device recovers, its samples become good again without intervention.
//
// A source and its clock belong to one thread.
// Units: those of the channels' names; s of the clock.
// Failure: none from Read, as the contract says.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hal/sample.h"

namespace abbe::hal {

struct Channel {
  std::string name;    // "probe_a_um"; ends in its unit
  std::string device;  // NAME of [devices.NAME]
};

// Receives one line for each change: a device fails, or recovers.
using Log = std::function<void(const std::string& line)>;

class SampleSource {
 public:
  virtual ~SampleSource() = default;
  virtual const std::vector<Channel>& channels() const = 0;
  // One sample a channel.
  virtual SampleSet Read() = 0;
  // There are no more samples (the end of a recording).
  virtual bool Ended() const { return false; }
  // The present fault of the device or the link, in one line; empty when there is none.
  virtual std::string Fault() const { return {}; }
};

// Sets time_s and skew_s of a set from the times of its samples and their uncertainty, and the age
// of each at `now_s`. `time_s` is `now_s` when every sample is bad.
void FinishSet(SampleSet& set, double now_s);

}  // namespace abbe::hal
