// A source whose values are checked against the travel of the machine and the range of the probes,
// which the judge of a single channel does not know.
//
// A value outside `good` becomes bad (out of range) and is not recorded. A value outside `possible`
// is no measurement but an error in the machine file (word order, type, scale, unit, another
// register), which Fault() reports while it lasts. Require() checks the first readings before
// anything is recorded.
//
//   PlausibleSource source(*devices.source, ranges);
//   for (const std::string& warning : source.Require(50, clock, rate)) {
//     fmt::print(stderr, "{}\n", warning);
//   }
//
// Units: those of the channels' names.
// Failure: InputError from Require where the first readings show an error in the machine file.
// Validity: intervals are wide: they find wrong words and units, not errors of a few per cent.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "hal/sample_source.h"

namespace abbe::hal {

struct Interval {
  double low, high;
  // Ends included.
  bool Holds(double value) const { return value >= low && value <= high; }
};

// In the unit of the channel's name.
struct PlausibleChannel {
  std::string name;
  Interval good, possible;
  std::string because;  // "the travel is 0 to 60 mm"
  // First readings below `least` on all channels that have one are an error in the machine file.
  double least = 0.0;
  double noise = 0.0;  // standard deviation of a reading; 0: not known
};

class PlausibleSource : public SampleSource {
 public:
  // `source` must outlive it. Channels without an entry pass as they are.
  PlausibleSource(SampleSource& source, const std::vector<PlausibleChannel>& channels);

  const std::vector<Channel>& channels() const override { return source_.channels(); }
  // A set of the source, judged.
  SampleSet Read() override;
  // As the source.
  bool Ended() const override { return source_.Ended(); }
  // That of the source, else an impossible value.
  std::string Fault() const override;

  // Reads `count` sets at `rate` Hz of the clock. InputError when they show an error in the machine
  // file (`least` is not checked on one set alone). Returns a warning for each channel without any
  // noise, or with a hundred times the stated noise, or a hundredth.
  std::vector<std::string> Require(int count, Clock& clock, double rate);

 private:
  struct First;  // the first readings of one channel
  std::string RefusalOf(const PlausibleChannel& channel, double value) const;
  void RefuseNothing(const std::vector<First>& first) const;

  SampleSource& source_;
  std::vector<std::optional<PlausibleChannel>> of_channel_;
  std::string slip_;
};

}  // namespace abbe::hal
