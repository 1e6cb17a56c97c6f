// A CANopen encoder on a bus in memory, with the habits of real ones: boots into pre-operational,
// answers SDO, sends a PDO at each SYNC once started.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "hal/can/can_in_process.h"
#include "hal/can/canopen_frame.h"
#include "hal/can/canopen_settings.h"

namespace abbe::hal {

class CanEncoderNode {
 public:
  using Angle = std::function<std::int64_t()>;  // the count at this moment

  CanEncoderNode(CanInProcess& wire, const EncoderSettings& encoder, Angle count)
      : objects{{{0x6000, 0}, 4},
                {{0x6001, 0}, static_cast<std::uint32_t>(encoder.counts_per_turn)},
                {{0x6002, 0}, static_cast<std::uint32_t>(encoder.range)},
                {{0x1018, 4}, static_cast<std::uint32_t>(1000 + encoder.node)}},
        encoder_(encoder),
        count_(std::move(count)) {
    bus_ = wire.Join([this](const ReceivedFrame& heard) { Hear(heard.frame); });
  }

  void Beat() {
    if (beats) bus_->Send(HeartbeatFrame(encoder_.node, state));
  }
  void Reboot(bool says_so = true) {
    state = NmtState::kPreOperational;
    if (says_so) bus_->Send(HeartbeatFrame(encoder_.node, NmtState::kBootUp));
  }
  void Say(std::uint16_t emergency) {
    bus_->Send(EmergencyFrame(encoder_.node, emergency, emergency == 0 ? 0 : 1));
  }
  void SendPdo() {
    CanFrame frame{.id = TpdoId(encoder_.tpdo, encoder_.node)};
    PutBits(frame, encoder_.at_bit, encoder_.bits, count_());
    bus_->Send(frame);
  }

  NmtState state = NmtState::kPreOperational;
  bool beats = true;
  bool answers_sdo = true;
  std::map<std::pair<int, int>, std::uint32_t> objects;

 private:
  void Hear(const CanFrame& frame) {
    if (frame.id == kSyncId && state == NmtState::kOperational) SendPdo();
    if (frame.id == kNmtId && (frame.data[1] == 0 || frame.data[1] == encoder_.node)) {
      if (frame.data[0] == 1) state = NmtState::kOperational;
      if (frame.data[0] == 128) state = NmtState::kPreOperational;
    }
    if (frame.id != kSdoBase + static_cast<std::uint32_t>(encoder_.node) || !answers_sdo) return;
    CanFrame reply = frame;
    reply.id = kSdoReplyBase + static_cast<std::uint32_t>(encoder_.node);
    const auto found =
        objects.find({static_cast<int>(*TakeBits(frame, 8, 16, false)), frame.data[3]});
    reply.data[0] = found != objects.end() ? 0x43 : 0x80;
    PutBits(reply, 32, 32, found != objects.end() ? found->second : 0x06020000);
    bus_->Send(reply);
  }

  EncoderSettings encoder_;
  Angle count_;
  std::unique_ptr<CanBus> bus_;
};

}  // namespace abbe::hal
