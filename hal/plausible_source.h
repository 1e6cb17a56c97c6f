// A source whose values are checked against the travel of the machine and the range of the probes,
// which the judge of a single channel does not know.
//
// A value outside `good` becomes bad (out of range) and is not recorded. A value outside `possible`
// is no measurement but an error in the machine file (word order, type, scale, unit, another
// register), which Fault() reports while it lasts. Require() checks the first readings before
// anything is recorded, Read() the noise of stays while it goes on.
//
//   PlausibleSource source(*devices.source, ranges);
//   for (const std::string& warning : source.Require(50, clock, rate)) {
//     fmt::print(stderr, "{}\n", warning);
//   }
//   const SampleSet set = source.Read();  // by a recorder, again and again
//   for (const std::string& noise : source.TakeWarnings()) fmt::print(stderr, "{}\n", noise);
//
// Units: those of the channels' names.
// Failure: InputError from Require where the first readings show an error in the machine file.
// Validity: intervals are wide: they find wrong words and units, not errors of a few per cent. The
// noise is judged in stays of 40 readings or more; the first 20 are left to the machine to settle.
#pragma once

#include <cstdint>
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
  // A position: the machine stands where all positions stay within this; 0: no position.
  double still = 0.0;
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

  // Since the last call: a warning for each channel whose noise at standstill came to ten times the
  // stated one, once for each channel.
  std::vector<std::string> TakeWarnings();

 private:
  // Readings of one channel, one after the other.
  struct Few {
    const PlausibleChannel* channel = nullptr;
    double count = 0.0, mean = 0.0, squares = 0.0;
    double lowest = 0.0, highest = 0.0;

    void Add(double value);
    double Deviation() const;
  };
  std::string RefusalOf(const PlausibleChannel& channel, double value) const;
  void RefuseNothing(const std::vector<Few>& first) const;
  // Begins again where the machine moved.
  void WatchStay(const SampleSet& set);
  void JudgeStay();

  SampleSource& source_;
  std::vector<std::optional<PlausibleChannel>> of_channel_;
  std::string slip_;
  std::vector<Few> stay_;
  int in_stay_ = 0;                  // sets; below 0: settling
  std::vector<std::uint8_t> noisy_;  // by channel, warned of already
  std::vector<std::string> warnings_;
};

}  // namespace abbe::hal
