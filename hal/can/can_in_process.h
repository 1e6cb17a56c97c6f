// A CAN bus in memory that fails on demand: for tests, for sanitizers, and for the virtual rig
// where the computer has no CAN.
//
//   CanInProcess wire(clock);
//   const auto master = wire.Join();
//   std::unique_ptr<CanBus> node =
//       wire.Join([&](const ReceivedFrame& heard) { node->Send(AnswerTo(heard.frame)); });
//   wire.Inject({.kind = CanTrouble::Kind::kLost, .id = 0x182, .from_s = 10, .to_s = 20});
//
// Participants may live in different threads. One with a callback `hear` is called at once, in the
// thread of the sender, and may send from there; the others fetch from their queue with Receive(),
// which waits by the clock (a HandClock then moves on by itself). Where there are several threads,
// `hear` must be thread-safe, and its participant must be destroyed while no frame is sent.
// Units: s of the clock.
// Failure: none; what goes wrong is what was injected.
// Validity: no arbitration: frames pass in the order in which they are sent.
#pragma once

#include <condition_variable>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "hal/can/can_bus.h"
#include "hal/clock.h"

namespace abbe::hal {

// What happens to frames with this id between these times.
struct CanTrouble {
  enum class Kind {
    kLost,
    kLate,     // arrives `late_s` after it was sent, behind frames sent meanwhile
    kDoubled,  // arrives twice
    kCorrupt,  // `mask` is laid over its data (exclusive or), byte 0 lowest
    kShort,    // arrives with at most `size` bytes
  };
  Kind kind = Kind::kLost;
  std::optional<std::uint32_t> id = {};  // empty: all frames
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  double late_s = 0.0;
  std::uint64_t mask = 0x80;
  std::uint8_t size = 0;
  int every = 1;  // acts on every n-th of these frames
};

class CanInProcess {
 public:
  using Hear = std::function<void(const ReceivedFrame& heard)>;

  // `queue`: frames that wait for one participant; beyond it the newest are lost and counted.
  // `clock` must outlive the bus, and the bus its participants.
  explicit CanInProcess(Clock& clock, std::size_t queue = 4096);
  ~CanInProcess();

  // Another participant; it must not outlive the bus.
  std::unique_ptr<CanBus> Join(Hear hear = {});

  // Adds to the troubles before.
  void Inject(const CanTrouble& trouble);
  // Ends all of them.
  void Heal();
  // For all participants. While the bus does not work nothing can be sent; what waits in the queues
  // is still received.
  void SetState(CanState state);
  std::uint64_t sent() const;  // frames that participants have sent so far

 private:
  class Participant;
  struct DelayedFrame;
  struct ActiveTrouble;
  void Transmit(const CanFrame& frame, const Participant* sender);
  void DeliverDue(double now_s);

  Clock& clock_;
  const std::size_t queue_;
  mutable std::mutex mutex_;
  std::condition_variable arrival_;
  std::vector<Participant*> participants_;
  std::vector<DelayedFrame> delayed_;  // in the order of their arrival
  std::vector<ActiveTrouble> troubles_;
  CanState state_ = CanState::kActive;
  std::uint64_t sent_ = 0;
};

}  // namespace abbe::hal
