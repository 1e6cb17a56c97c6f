// The steady pace of a recorder, and whether it was kept.
//
// A recorder that is suspended (SIGSTOP, a laptop's lid) or gets no processor takes its next
// reading late. The reading is valid, but the interval before it is longer than planned: its row is
// flagged (Cause::kClockJump). The source detects a suspension during a reading.
//
//   while (goes_on) {
//     const bool kept = pace.Await();
//     const SampleSet set = source.Read();
//     pace.Done();
//   }
//
// Units: s of the clock; kLate in real time.
// Failure: none.
#pragma once

#include <algorithm>

#include "hal/clock.h"

namespace abbe::hal {

class Pace {
 public:
  static constexpr double kLate = 0.1;  // s of real time

  // `rate`: Hz of the clock, which must outlive the pace.
  Pace(Clock& clock, double rate) : clock_(clock), period_s_(1.0 / rate) { Begin(); }

  // The next reading is due now.
  void Begin() { next_s_ = free_s_ = clock_.Now(); }

  // Returns when the next reading is due: false when it is more than kLate overdue although no
  // reading was in progress.
  bool Await() {
    const double due_s = std::max(next_s_, free_s_);
    clock_.SleepUntil(due_s);
    now_s_ = clock_.Now();
    next_s_ = std::max(next_s_ + period_s_, now_s_);
    return now_s_ - due_s <= kLate * clock_.speed();
  }

  // The reading is over.
  void Done() { free_s_ = clock_.Now(); }

  double now_s() const { return now_s_; }    // when Await() returned
  double next_s() const { return next_s_; }  // when the reading after that is due

 private:
  Clock& clock_;
  double period_s_;
  double next_s_ = 0.0, free_s_ = 0.0, now_s_ = 0.0;
};

}  // namespace abbe::hal
