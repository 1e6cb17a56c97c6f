// A SocketCAN interface as a bus.
//
// Frames are stamped by the kernel when they pass the interface. One system call fetches all frames
// that have arrived, with their stamps; the age of a stamp converts it to the measurement's clock.
// Error frames set state() and are not returned. An interface that is switched off or removed is
// awaited: each call of Receive() checks whether it is back, at most every 50 ms.
// Units: s of the clock.
// Failure: none is thrown; state() and Fault() say it.
// Source: SocketCAN of Linux.
// Validity: stamps are as good as the kernel's, some microseconds.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hal/can/can_bus.h"
#include "hal/clock.h"

namespace abbe::hal {

class CanSocket : public CanBus {
 public:
  // Never throws for an interface that does not exist: state() and Fault() report it. `clock` must
  // outlive the bus. `only`: the identifiers (11 bits) to receive, the others are left to the
  // kernel; empty: all. `buffer` in bytes; the kernel may grant less without the right to force it.
  CanSocket(std::string interface, Clock& clock, std::vector<std::uint32_t> only = {},
            int buffer = 4 << 20);
  ~CanSocket() override;
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  // False while the queue of the interface is full.
  bool Send(const CanFrame& frame) override;
  // Waits in the kernel.
  std::optional<ReceivedFrame> Receive(double until_s) override;
  CanState state() const override { return state_; }
  // With the name of the interface.
  std::string Fault() const override;
  std::uint64_t lost() const override { return lost_; }
  std::uint64_t errors() const override { return errors_; }

 private:
  struct MessageBuffer;
  struct Batch;

  void Open();
  void Close();
  void Recover();        // if the interface is back
  void Fail(int error);  // of a system call
  bool InterfaceUp() const;
  void Fetch();  // into the batch
  // False when it is not to be returned.
  bool Understand(MessageBuffer& buffer, ReceivedFrame& received);
  void HearErrorFrame(std::uint32_t id, const std::uint8_t* data);
  double TimeOf(double age_s);
  bool Wait(double until_s);  // false: the time is over

  const std::string interface_;
  Clock& clock_;
  const std::vector<std::uint32_t> only_;
  const int buffer_;
  int socket_ = -1;
  CanState state_ = CanState::kGone;
  std::string reason_;          // why it is gone, where the kernel gave one
  double looked_s_ = 0.0;       // last check for the interface
  double last_s_ = 0.0;         // stamp of the last frame
  std::uint32_t overflow_ = 0;  // of the kernel's counter
  std::uint64_t lost_ = 0;
  std::uint64_t errors_ = 0;
  std::unique_ptr<Batch> batch_;
  std::size_t next_ = 0, fetched_ = 0;  // of the batch
  bool drained_ = false;                // the kernel had no more
};

}  // namespace abbe::hal
