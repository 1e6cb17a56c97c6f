// A CANopen encoder of the virtual rig as a device on the bus: a rotary absolute encoder of the
// profile CiA 406. It is given frames and a function to send; it has no bus, clock or thread.
//
//   const auto send = [&](const hal::CanFrame& frame) { bus.Send(frame); };
//   EncoderNode node(settings, send);
//   node.Boot();
//   node.Hear(frame);   // a command, a question
//   node.Sync(angle);   // a SYNC: it answers with its angle
//
// It sends its boot-up message, waits pre-operational for the start command (NMT), sends its count
// in the PDO of its settings at each SYNC while operational, answers SDO uploads of its objects
// (Describe() in encoder_node.cpp) and refuses downloads. Without an angle it sends emergency 5000h
// (hardware) and repeats its last count; the next angle clears the emergency.
//
// It builds its frames from CiA 301 and 406 and shares no code with the client in hal that is
// tested against it. Units: rad.
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

  // The count nearest to an angle, within the range.
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
