// A source whose numbers are held against what they can be.
//
// The judge of a channel knows its registers; what the machine can do, and how far a probe sees, it
// does not. A number outside `good` becomes bad (out of range), so that no row holds it; one
// outside `possible` is no measurement at all but a slip of the machine file (word order, type,
// scale, unit, another register), and Fault() says so as long as it lasts. Require() looks at the
// first readings before anything is recorded.
//
//   PlausibleSource source(*devices.source, ranges);
//   for (const std::string& warning : source.Require(50, clock, rate)) {
//     fmt::print(stderr, "{}\n", warning);
//   }
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "hal/sample_source.h"

namespace abbe::hal {

struct Interval {
  double low, high;
  bool Holds(double value) const { return value >= low && value <= high; }
};

// In the unit of the channel's name.
struct PlausibleChannel {
  std::string name;
  Interval good, possible;
  std::string because;  // "the travel is 0 to 60 mm"
  double least = 0.0;  // the channels with one: first readings below it, on all of them, are a slip
  double noise = 0.0;  // standard deviation that a reading has; 0: nobody knows
};

class PlausibleSource : public SampleSource {
 public:
  // `source` must outlive it. Channels without an entry pass as they are.
  PlausibleSource(SampleSource& source, const std::vector<PlausibleChannel>& channels);

  const std::vector<Channel>& channels() const override { return source_.channels(); }
  SampleSet Read() override;
  bool Ended() const override { return source_.Ended(); }
  std::string Fault() const override;

  // Reads `count` sets at `rate` Hz of the clock. InputError when they are a slip of the machine
  // file (one set alone is not asked whether all gaps are next to nothing). Returns what else is
  // strange about them, one line each: channels without any noise, and noise a hundred times what
  // it should be, or a hundredth.
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
