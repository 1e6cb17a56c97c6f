// The seam between whatever gives readings and whoever records them.
//
// Siblings: ModbusSource (a device), ReplaySource (a recording), FakeSource (faults on demand),
// CombinedSource (several of these as one). One contract holds for all, and one test checks it:
//
//   - channels() never changes; Read() gives one sample for each of them, in that order.
//   - Read() returns within the deadline of its devices and never throws for what a device does; it
//     says so by the quality and the cause of the samples, and by Fault().
//   - Frozen, saturated, sentinel, stale, lost or corrupt is never good, and carries NaN.
//   - Sequence numbers and times never go back; a reading handed over twice is not good twice.
//   - When the device is well again, so are its samples, without anybody's help.
//
// A source and its clock belong to one thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hal/sample.h"

namespace abbe::hal {

struct Channel {
  std::string name;    // "probe_a_um"; ends in its unit
  std::string device;  // where it comes from, for messages
};

// One line, once per change: a device that fails, and the same device when it is well again.
using Log = std::function<void(const std::string& line)>;

class SampleSource {
 public:
  virtual ~SampleSource() = default;
  virtual const std::vector<Channel>& channels() const = 0;
  virtual SampleSet Read() = 0;
  // Nothing more will come (the end of a recording).
  virtual bool Ended() const { return false; }
  // What is wrong at present with the way to the readings, in one line; empty when all is well.
  virtual std::string Fault() const { return {}; }
};

// Sets time_s and skew_s of a set from its samples, what is not known of their times included, and
// the age of each at `now_s`. `time_s` is `now_s` when every sample is bad.
void FinishSet(SampleSet& set, double now_s);

}  // namespace abbe::hal
