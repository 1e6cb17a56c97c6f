#include "hal/can/can_in_process.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

namespace abbe::hal {

struct CanInProcess::DelayedFrame {
  CanFrame frame;
  double due_s;
  const Participant* sender;
};

struct CanInProcess::ActiveTrouble {
  CanTrouble trouble;
  int seen = 0;

  bool Strikes(const CanFrame& frame, double now_s) {
    if (now_s < trouble.from_s || now_s >= trouble.to_s) return false;
    if (trouble.id && *trouble.id != frame.id) return false;
    return ++seen % trouble.every == 0;
  }
};

class CanInProcess::Participant : public CanBus {
 public:
  Participant(CanInProcess& wire, Hear listener) : hear(std::move(listener)), wire_(wire) {}
  ~Participant() override {
    const std::lock_guard lock(wire_.mutex_);
    std::erase(wire_.participants_, this);
  }

  bool Send(const CanFrame& frame) override {
    if (!Works(state())) return false;
    wire_.Transmit(frame, this);
    return true;
  }

  std::optional<ReceivedFrame> Receive(double until_s) override {
    while (true) {
      const double now = wire_.clock_.Now();
      wire_.DeliverDue(now);
      std::unique_lock lock(wire_.mutex_);
      if (!queue.empty()) {
        const ReceivedFrame received = queue.front();
        queue.pop_front();
        return received;
      }
      if (now >= until_s) return {};
      double wake_s = until_s;
      if (!wire_.delayed_.empty()) wake_s = std::min(wake_s, wire_.delayed_.front().due_s);
      wire_.clock_.WaitUntil(wake_s, lock, wire_.arrival_);
    }
  }

  CanState state() const override {
    const std::lock_guard lock(wire_.mutex_);
    return wire_.state_;
  }
  std::string Fault() const override {
    const CanState now = state();
    return Works(now) ? std::string() : fmt::format("CAN in process: {}", NameOf(now));
  }
  std::uint64_t lost() const override {
    const std::lock_guard lock(wire_.mutex_);
    return lost_frames;
  }
  std::uint64_t errors() const override { return 0; }

  const Hear hear;
  std::deque<ReceivedFrame> queue;  // under the mutex of the wire, as is the next
  std::uint64_t lost_frames = 0;

 private:
  CanInProcess& wire_;
};

CanInProcess::CanInProcess(Clock& clock, std::size_t queue) : clock_(clock), queue_(queue) {}
CanInProcess::~CanInProcess() = default;

std::unique_ptr<CanBus> CanInProcess::Join(Hear hear) {
  auto participant = std::make_unique<Participant>(*this, std::move(hear));
  const std::lock_guard lock(mutex_);
  participants_.push_back(participant.get());
  return participant;
}

void CanInProcess::Inject(const CanTrouble& trouble) {
  const std::lock_guard lock(mutex_);
  troubles_.push_back({trouble});
}

void CanInProcess::Heal() {
  const std::lock_guard lock(mutex_);
  troubles_.clear();
}

void CanInProcess::SetState(CanState state) {
  const std::lock_guard lock(mutex_);
  state_ = state;
}

std::uint64_t CanInProcess::sent() const {
  const std::lock_guard lock(mutex_);
  return sent_;
}

void CanInProcess::Transmit(const CanFrame& frame, const Participant* sender) {
  const double now = clock_.Now();
  {
    const std::lock_guard lock(mutex_);
    ++sent_;
    DelayedFrame message{frame, now, sender};
    int copies = 1;
    for (ActiveTrouble& acting : troubles_) {
      if (!acting.Strikes(frame, now)) continue;
      const CanTrouble& trouble = acting.trouble;
      switch (trouble.kind) {
        case CanTrouble::Kind::kLost:
          copies = 0;
          break;
        case CanTrouble::Kind::kLate:
          message.due_s += trouble.late_s;
          break;
        case CanTrouble::Kind::kDoubled:
          copies *= 2;
          break;
        case CanTrouble::Kind::kCorrupt:
          for (std::size_t i = 0; i < message.frame.data.size(); ++i) {
            message.frame.data[i] ^= static_cast<std::uint8_t>(trouble.mask >> (8 * i));
          }
          break;
        case CanTrouble::Kind::kShort:
          message.frame.size = std::min(message.frame.size, trouble.size);
          break;
      }
    }
    const auto later = [](double due_s, const DelayedFrame& other) { return due_s < other.due_s; };
    delayed_.insert(std::upper_bound(delayed_.begin(), delayed_.end(), message.due_s, later),
                    copies, message);
  }
  DeliverDue(now);
}

void CanInProcess::DeliverDue(double now_s) {
  std::unique_lock lock(mutex_);
  while (!delayed_.empty() && delayed_.front().due_s <= now_s) {
    const DelayedFrame message = delayed_.front();
    delayed_.erase(delayed_.begin());
    std::vector<Participant*> called;
    for (Participant* participant : participants_) {
      const bool own = participant == message.sender;
      if (participant->hear) {
        if (!own) called.push_back(participant);
      } else if (participant->queue.size() < queue_) {
        participant->queue.push_back({message.frame, message.due_s, own});
      } else {
        ++participant->lost_frames;
      }
    }
    arrival_.notify_all();
    lock.unlock();  // they may send
    for (Participant* participant : called)
      participant->hear({message.frame, message.due_s, false});
    lock.lock();
  }
}

}  // namespace abbe::hal
