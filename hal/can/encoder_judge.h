// Decides whether a count of an encoder is a measurement, and which turn it belongs to.
//
// The first count is taken as the angle nearest to zero, each further one as that nearest to the
// one before, modulo the range. A step beyond `fastest` is bad (jump) and leaves the position where
// it was; three in a row that agree with each other mean that the encoder has another zero now (a
// preset, a slip): the reference is lost, and stays so until it is confirmed. Knows no bus and no
// clock.
// Units: counts, rad, s.
// Failure: none; a count that is no measurement is a bad sample.
// Validity: the shaft turns by less than half of the range between two counts.
#pragma once

#include <optional>

#include "hal/can/canopen_settings.h"
#include "hal/sample.h"

namespace abbe::hal {

class EncoderJudge {
 public:
  // `stale_s` as in DevicesSettings.
  EncoderJudge(const EncoderSettings& encoder, double stale_s)
      : encoder_(encoder), stale_s_(stale_s) {}

  // A count, measured at `time_s` and returned at `now_s`.
  Sample Judge(std::int64_t count, double time_s, double now_s);
  // No new count, for this cause.
  Sample Missing(Cause cause, double now_s) const { return Sample::Bad(cause, now_s, sequence_); }

  // Without effect before the first accepted count: there is no reference yet.
  void LoseReference() { reference_lost_ = reference_lost_ || last_; }
  // The next count is a first one again.
  void ConfirmReference();
  bool reference_lost() const { return reference_lost_; }

 private:
  struct Reading {
    std::int64_t count;
    double time_s;
  };
  // Whether the encoder can have moved from one to the other.
  bool Reachable(const Reading& from, const Reading& to) const;
  bool InRange(std::int64_t count) const;
  Cause Follow(const Reading& reading);  // moves position_, or returns why not

  EncoderSettings encoder_;
  double stale_s_;
  std::optional<Reading> last_;     // the last that was accepted
  std::optional<Reading> suspect_;  // the last jump
  int suspects_ = 0;                // jumps in a row that agree
  std::int64_t position_ = 0;       // unwrapped count from the zero
  double changed_s_ = 0.0;
  double heard_s_ = 0.0;  // of the last count, accepted or not
  std::uint64_t sequence_ = 0;
  bool reference_lost_ = false;
};

}  // namespace abbe::hal
