// A log of CAN traffic as if the bus carried it again: a bus on which one can only listen.
//
// The clock sets the pace, as with ReplaySource: a SteadyClock replays in real time, a HandClock as
// fast as possible. Stamps are those of the log, counted from the clock's time at the first frame.
// Units: s of the clock.
// Failure: InputError for an interface that the log has not.
// Source: hal/can/candump_log.h.
#pragma once

#include <string>
#include <vector>

#include "hal/can/can_bus.h"
#include "hal/can/candump_log.h"
#include "hal/clock.h"

namespace abbe::hal {

class CanReplay : public CanBus {
 public:
  // Only the frames of `interface`. InputError, naming those that are there, when it has none.
  // `clock` must outlive the bus.
  CanReplay(const CandumpLog& log, const std::string& interface, Clock& clock);

  // Takes no frames.
  bool Send(const CanFrame&) override { return false; }
  // The next of the log, when its time has come.
  std::optional<ReceivedFrame> Receive(double until_s) override;
  CanState state() const override { return CanState::kActive; }
  // None, ever.
  std::string Fault() const override { return {}; }
  std::uint64_t lost() const override { return 0; }
  std::uint64_t errors() const override { return 0; }
  // After the last frame.
  bool Ended() const override { return next_ == frames_.size(); }
  // The time of the next frame by the clock; after the last frame, its time.
  double NextTime() const;

 private:
  struct Passage {
    double time_s;
    CanFrame frame;
  };
  std::vector<Passage> frames_;
  Clock& clock_;
  double start_s_;
  std::size_t next_ = 0;
};

}  // namespace abbe::hal
