// Stretches of dwells in which a channel is frozen: every reading the same to the last digit, where
// the noise of the probe's other dwells moves it from one reading to the next.
//
// A run of dwells is frozen if n equal readings in a row are not chance: N P^(n - 1) < 1e-6 with N
// readings in all and P = erf(q / (2 sqrt(2) s)), the most that noise s leaves within one step q of
// the reading (the smallest change that occurs; s^2 is the variance within the other dwells less
// q^2 / 12). Where steps are wider than s, or the other dwells often show one reading only, nothing
// is said. A dwell beside the run that begins or ends with its reading belongs to it: the channel
// froze or woke there.
//
// Units: those of the readings. Shapes: the dwells of one probe, in the order of time.
// Failure: none.
// Source: own.
// Validity: two dwells or more; a dwell with one reading tells nothing and breaks a run.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace abbe::probes {

// What the readings of one probe in one dwell show of this.
class DwellReadings {
 public:
  void Add(double reading);

  double first() const { return first_; }
  double last() const { return last_; }
  std::size_t count() const { return count_; }
  bool Constant() const { return count_ > 1 && least_change_ == kNone; }
  double least_change() const { return least_change_; }  // not 0; infinite where all are the same
  double squares() const { return squares_; }            // of the deviations from their mean

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  double first_ = 0.0, last_ = 0.0, mean_ = 0.0, squares_ = 0.0, least_change_ = kNone;
  std::size_t count_ = 0;
};

// The dwells first to last, both included.
struct FrozenRun {
  std::size_t first, last;
  double reading;
};

std::vector<FrozenRun> FindFrozen(std::span<const DwellReadings> dwells);

}  // namespace abbe::probes
