// A CAN bus as one participant sees it: the interface between encoders and the driver.
//
// Implementations: CanSocket (a SocketCAN interface), CanInProcess (a bus in memory that fails on
// demand), CanReplay (a log; takes no frames). One contract holds for all:
//
//   - Receive() returns the frames of the bus in their order, its own included (`own`), each
//     stamped by the one clock when it passed the bus, never later than now and never before the
//     previous frame.
//   - Receive() returns at the latest at its deadline; neither call throws for a fault of the bus.
//   - A frame that the receiving queue had no room for is counted by lost() at the latest with the
//     next frame that arrives.
//   - When the bus recovers, so does this participant, without intervention.
//
// A participant belongs to one thread. Classic CAN only (8 bytes of data).
// Units: s on the clock of the measurement.
// Failure: none is thrown for a fault of the bus; Fault() says it.
// Source: ISO 11898-1, classic CAN; SocketCAN of Linux for the states.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace abbe::hal {

struct CanFrame {
  std::uint32_t id = 0;  // 11 bits, or 29 when `extended`
  bool extended = false;
  bool remote = false;    // a request for the frame of this id; carries no data
  std::uint8_t size = 0;  // 0 to 8
  std::array<std::uint8_t, 8> data{};

  friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

struct ReceivedFrame {
  CanFrame frame;
  double time_s = 0.0;  // when it passed the bus, by the clock of the measurement
  bool own = false;     // sent by this participant
};

enum class CanState {
  kActive,
  kWarning,  // many errors; still works
  kPassive,  // more; still works
  kBusOff,   // the controller has taken itself off the bus
  kDown,     // the interface is there and switched off
  kGone,     // there is no such interface
};

// As printed: "bus-off".
std::string_view NameOf(CanState state);

class CanBus {
 public:
  virtual ~CanBus() = default;

  // False when the frame was not taken: Fault() gives the reason, or the queue to the bus is full.
  virtual bool Send(const CanFrame& frame) = 0;
  // The next frame; none when none arrived by `until_s` of the clock, or the bus does not work.
  // A time in the past does not wait.
  virtual std::optional<ReceivedFrame> Receive(double until_s) = 0;

  virtual CanState state() const = 0;
  // Why the bus carries no frames, in one line: "can0: bus-off"; empty when it works.
  virtual std::string Fault() const = 0;
  virtual std::uint64_t lost() const = 0;    // frames that the receiving queue had no room for
  virtual std::uint64_t errors() const = 0;  // error frames that the controller reported
  // There are no more frames (the end of a log).
  virtual bool Ended() const { return false; }
};

// Whether frames pass.
inline bool Works(CanState state) { return state <= CanState::kPassive; }

}  // namespace abbe::hal
