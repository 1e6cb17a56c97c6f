// A CANopen encoder of the virtual rig as a device on the bus: a rotary absolute encoder of the
// profile CiA 406, fed with the frames that pass; it knows no bus, no clock and no thread.
//
//   EncoderNode node(settings, [&](const hal::CanFrame& frame) { bus.Send(frame); });
//   node.Boot();
//   node.Hear(frame);   // a command, a question
//   node.Sync(angle);   // a SYNC: it looks at its shaft and answers
//
// It says boot-up, waits pre-operational for the command to start (NMT), sends its count in the PDO
// of its settings at each SYNC while operational, answers SDO uploads of its objects (what they
// are: Describe() in encoder_node.cpp) and refuses downloads. A shaft that cannot be told (no
// angle) is an emergency 5000h (hardware) until it can; meanwhile the last count is sent on.
//
// Its frames are put together here, from CiA 301 and 406, and by nothing of the client in hal that
// is tested against it. Units: rad.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "hal/can/can_bus.h"
#include "hal/can/canopen_settings.h"

namespace abbe::rig {

class EncoderNode {
 public:
  using Send = std::function<void(const hal::CanFrame& frame)>;

  EncoderNode(const hal::EncoderSettings& encoder, Send send);

  void Boot();
  void Beat();  // the heartbeat
  void Hear(const hal::CanFrame& frame);
  void Sync(std::optional<double> angle);

  // The count that stands for an angle: the nearest, within the range.
  std::int64_t CountAt(double angle) const;

 private:
  enum class State : std::uint8_t {
    kBooting = 0,
    kStopped = 4,
    kOperational = 5,
    kPreOperational = 127
  };
  struct Object {
    std::uint32_t value;
    int bytes;
  };

  void Describe();
  void Put(std::uint32_t index, int sub, std::uint32_t value, int bytes);
  void Obey(std::uint8_t command);
  void Answer(const hal::CanFrame& question);
  void Say(bool trouble);

  hal::EncoderSettings encoder_;
  Send send_;
  State state_ = State::kBooting;
  bool trouble_ = false;
  double shaft_ = 0.0;  // rad, turns counted
  std::int64_t count_ = 0;
  std::map<std::uint32_t, Object> objects_;  // index * 256 + sub-index
};

}  // namespace abbe::rig
