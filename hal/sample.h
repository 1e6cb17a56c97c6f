// One reading of one channel, with its quality.
//
// Only `good` is a measurement. A bad sample carries NaN, so that its number cannot be used by
// mistake, and exactly one cause; an uncertain one carries a number that was not measured as it
// stands.
// Units: that of the channel's name; s.
// Failure: none.
// Validity: a good sample is plausible, not proven right.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace abbe::hal {

enum class Quality { kGood, kUncertain, kBad };

enum class Cause {
  kNone,           // good
  kWaiting,        // no reading yet
  kStale,          // the reading is older than allowed
  kFrozen,         // the register has not changed for longer than allowed
  kOutOfRange,     // saturated, or outside minimum..maximum
  kSentinel,       // the device's own sign for "no value"
  kSensorFault,    // reported by the status register
  kNotANumber,     // NaN or infinite in the register
  kNoReply,        // link down, time-out, or a reply that is not to be trusted
  kRefused,        // an exception code
  kJump,           // further from the reading before than anything can have moved
  kReferenceLost,  // the encoder has started anew or has another zero: its angle means nothing yet
  kMismatch,       // the device is not the one that the machine file describes
  kIncoherent,     // too far in time from the other samples of its set
  kInterpolated,   // uncertain: interpolated before it was recorded
  kClockJump,      // time went on by more than it should: when it was measured is not known
};

// As printed: "good", "out of range".
std::string_view NameOf(Quality quality);
std::string_view NameOf(Cause cause);

struct Sample {
  double value = std::numeric_limits<double>::quiet_NaN();  // in the unit of the channel's name
  Quality quality = Quality::kBad;
  Cause cause = Cause::kWaiting;
  double time_s = 0.0;         // when it was measured, by the clock of the measurement
  std::uint64_t sequence = 0;  // counts the readings of this channel; 0: none yet
  double age_s = 0.0;          // when it was returned
  double within_s = 0.0;       // it was measured within time_s -+ this

  // A measurement.
  static Sample Good(double value, double time_s, std::uint64_t sequence) {
    return {value, Quality::kGood, Cause::kNone, time_s, sequence, 0.0, 0.0};
  }
  // NaN with its cause.
  static Sample Bad(Cause cause, double time_s, std::uint64_t sequence) {
    return {
        std::numeric_limits<double>::quiet_NaN(), Quality::kBad, cause, time_s, sequence, 0.0, 0.0};
  }
  bool good() const { return quality == Quality::kGood; }
};

// One sample of every channel of a source, in the order of its channels().
struct SampleSet {
  double time_s = 0.0;         // middle of the samples' times
  std::uint64_t sequence = 0;  // counts the sets, from 1
  double skew_s = 0.0;         // within which all samples that are not bad were measured
  std::vector<Sample> samples;

  // Every one of them.
  bool AllGood() const;
};

}  // namespace abbe::hal
