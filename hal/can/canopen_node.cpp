#include "hal/can/canopen_node.h"

#include <fmt/format.h>

namespace abbe::hal {
namespace {

constexpr double kAnswerTimeout = 0.5;  // s, of an SDO
constexpr double kStartAgain = 0.25;    // s, between two commands to start

struct Object {
  std::uint16_t index;
  std::uint8_t sub;
};
constexpr std::array<Object, 6> kObjects{
    {{0x6000, 0}, {0x6001, 0}, {0x6002, 0}, {0x6501, 0}, {0x6502, 0}, {0x1018, 4}}};

}  // namespace

CanopenNode::CanopenNode(const EncoderSettings& encoder, const CanopenTimes& times, double speed,
                         bool asks)
    : encoder_(encoder), times_(times), speed_(speed), asks_(asks) {
  if (!asks_) started_s_ = 0.0;
}

bool CanopenNode::Alive(double now_s) const {
  if (!asks_ || times_.heartbeat == 0.0) return true;
  return heard_s_ && now_s - *heard_s_ <= times_.heartbeat * speed_;
}

bool CanopenNode::Starting(double now_s) const {
  return !started_s_ && described() && !overdue_ && Alive(now_s);
}

bool CanopenNode::HearState(NmtState state) {
  const bool anew = state == NmtState::kBootUp
                        ? started_s_.has_value()
                        : state == NmtState::kPreOperational && state_ == NmtState::kOperational;
  state_ = state;
  if (!anew) return false;
  emergency_.reset();
  if (asks_) {
    question_ = 0;
    asked_s_.reset();
    started_s_.reset();
  }
  return true;
}

bool CanopenNode::Hear(const ReceivedFrame& received) {
  if (received.own) return false;
  if (const auto heartbeat = HeartbeatOf(received.frame)) {
    if (heartbeat->node != encoder_.node) return false;
    heard_s_ = received.time_s;
    return HearState(heartbeat->state);
  }
  if (const auto emergency = EmergencyOf(received.frame)) {
    if (emergency->node != encoder_.node) return false;
    emergency_ = emergency->code == 0 ? std::nullopt : emergency;
  } else if (const auto reply = SdoReplyOf(received.frame)) {
    if (reply->node == encoder_.node) HearAnswer(*reply);
  }
  return false;
}

void CanopenNode::HearAnswer(const SdoReply& reply) {
  if (question_ == kQuestions || !asked_s_) return;
  const std::size_t at = question_;
  if (reply.index != kObjects[at].index || reply.sub != kObjects[at].sub) return;
  answers_[at] = reply.value;
  asked_s_.reset();
  overdue_ = false;
  if (++question_ == kQuestions) Compare();
}

void CanopenNode::Ask(CanBus& bus, double now_s) {
  if (asked_s_ && now_s - *asked_s_ < kAnswerTimeout * speed_) return;
  overdue_ = asked_s_.has_value();
  const Object& object = kObjects[question_];
  bus.Send(SdoReadFrame(encoder_.node, object.index, object.sub));
  asked_s_ = now_s;
}

void CanopenNode::Act(CanBus& bus, double now_s, bool silent) {
  if (!asks_ || !Alive(now_s)) return;
  if (question_ < kQuestions) return Ask(bus, now_s);
  if (!described()) return;
  const bool running = state_ == NmtState::kOperational || !silent;
  if (started_s_ && (running || now_s - *started_s_ < kStartAgain * speed_)) return;
  bus.Send(NmtFrame(NmtCommand::kStart, encoder_.node));
  started_s_ = now_s;
}

void CanopenNode::Compare() {
  constexpr std::uint32_t kScalingOn = 4;  // bit 2 of object 6000h
  const bool scaled =
      answers_[kPerTurn] && (answers_[kOperating].value_or(kScalingOn) & kScalingOn);
  const auto per_turn = answers_[scaled ? kPerTurn : kPhysicalPerTurn];
  // The product of two words of 32 bits needs all 64.
  const std::uint64_t range = !scaled && per_turn
                                  ? std::uint64_t{*per_turn} * answers_[kTurns].value_or(1)
                                  : std::uint64_t{answers_[kRange].value_or(0)};
  const auto serial = answers_[kSerial];
  mismatch_.clear();
  if (encoder_.serial && serial && serial != encoder_.serial) {
    mismatch_ = fmt::format("has the serial number {}, the machine file says {}", *serial,
                            *encoder_.serial);
  } else if (per_turn && *per_turn != encoder_.counts_per_turn) {
    mismatch_ = fmt::format("counts {} a turn, the machine file says {}", *per_turn,
                            encoder_.counts_per_turn);
  } else if (range != 0 && range != static_cast<std::uint64_t>(encoder_.range)) {
    mismatch_ = fmt::format("begins again after {} counts, the machine file says {}", range,
                            encoder_.range);
  }
}

std::string CanopenNode::Fault(double now_s) const {
  const auto say = [&](const std::string& what) {
    return fmt::format("node {} ({}): {}", encoder_.node, encoder_.name, what);
  };
  if (!Alive(now_s)) {
    return say(fmt::format("no heartbeat for {:.0f} ms", 1e3 * times_.heartbeat));
  }
  if (overdue_) return say("does not answer questions (SDO)");
  if (!described()) return say(mismatch_);
  if (asks_ && question_ < kQuestions) return say("is being asked what it is");
  if (emergency_) return say(EmergencyText(*emergency_));
  return {};
}

}  // namespace abbe::hal
