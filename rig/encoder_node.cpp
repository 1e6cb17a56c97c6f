#include "rig/encoder_node.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace abbe::rig {
namespace {

using hal::CanFrame;

// Abort codes of CiA 301.
constexpr std::uint32_t kNoSuchCommand = 0x05040001, kReadOnly = 0x06010002,
                        kNoSuchObject = 0x06020000, kNoSuchSubIndex = 0x06090011;
constexpr std::uint32_t kHardwareTrouble = 0x5000;
constexpr int kHeartbeatMs = 100;

void PutBytes(CanFrame& frame, std::size_t at, int bytes, std::uint64_t value) {
  for (int i = 0; i < bytes; ++i) {
    frame.data[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

CanFrame FrameOf(std::uint32_t base, int node, int size) {
  return {.id = base + node, .size = static_cast<std::uint8_t>(size)};
}

}  // namespace

EncoderNode::EncoderNode(const hal::EncoderSettings& encoder, Send send)
    : encoder_(encoder), send_(std::move(send)) {
  Describe();
}

void EncoderNode::Put(std::uint32_t index, int sub, std::uint32_t value, int bytes) {
  objects_[index << 8 | static_cast<std::uint32_t>(sub)] = {value, bytes};
}

void EncoderNode::Describe() {
  // The objects have 32 bits: 2^32 reads 0.
  const auto per_turn = static_cast<std::uint32_t>(std::llround(encoder_.counts_per_turn));
  const auto range = static_cast<std::uint32_t>(encoder_.range);
  const auto turns =
      static_cast<std::uint32_t>(std::llround(encoder_.range / encoder_.counts_per_turn));
  const std::uint32_t pdo = 0x80 + 0x100 * static_cast<std::uint32_t>(encoder_.tpdo);
  const std::uint32_t nth = encoder_.tpdo - 1;
  Put(0x1000, 0, turns > 1 ? 0x00020196 : 0x00010196, 4);  // profile 406, absolute
  Put(0x1001, 0, 0, 1);                                    // error register
  Put(0x1017, 0, kHeartbeatMs, 2);
  Put(0x1018, 0, 4, 1);  // identity
  for (int sub = 1; sub <= 3; ++sub) Put(0x1018, sub, 0, 4);
  Put(0x1018, 4, encoder_.serial.value_or(static_cast<std::uint32_t>(encoder_.node)), 4);
  Put(0x1800 + nth, 0, 2, 1);
  Put(0x1800 + nth, 1, pdo + encoder_.node, 4);
  Put(0x1800 + nth, 2, 1, 1);  // at every SYNC
  Put(0x1A00 + nth, 0, 1, 1);
  Put(0x1A00 + nth, 1, 0x60040000 | static_cast<std::uint32_t>(encoder_.bits), 4);
  Put(0x6000, 0, 4, 2);  // scaling is on
  Put(0x6001, 0, per_turn, 4);
  Put(0x6002, 0, range, 4);
  Put(0x6004, 0, 0, 4);
  Put(0x6501, 0, per_turn, 4);
  Put(0x6502, 0, turns, 2);
}

void EncoderNode::Boot() {
  state_ = State::kBooting;
  Beat();
  state_ = State::kPreOperational;
  if (trouble_) Say(true);
}

void EncoderNode::Beat() {
  CanFrame frame = FrameOf(0x700, encoder_.node, 1);
  frame.data[0] = static_cast<std::uint8_t>(state_);
  send_(frame);
}

void EncoderNode::Hear(const CanFrame& frame) {
  if (frame.extended || frame.remote) return;
  if (frame.id == 0x000 && frame.size >= 2) {
    if (frame.data[1] == 0 || frame.data[1] == encoder_.node) Obey(frame.data[0]);
  } else if (frame.id == FrameOf(0x600, encoder_.node, 0).id && frame.size == 8) {
    if (state_ != State::kStopped) Answer(frame);
  }
}

void EncoderNode::Obey(std::uint8_t command) {
  switch (command) {
    case 1:
      state_ = State::kOperational;
      break;
    case 2:
      state_ = State::kStopped;
      break;
    case 128:
      state_ = State::kPreOperational;
      break;
    case 129:
    case 130:
      Boot();
      break;
    default:
      break;
  }
}

void EncoderNode::Answer(const CanFrame& question) {
  const int command = question.data[0] & 0xE0;
  if (command == 0x80) return;  // the other side gives up
  CanFrame reply = FrameOf(0x580, encoder_.node, 8);
  for (std::size_t i = 1; i < 4; ++i) reply.data[i] = question.data[i];
  const auto abort = [&](std::uint32_t code) {
    reply.data[0] = 0x80;
    PutBytes(reply, 4, 4, code);
    send_(reply);
  };
  if (command == 0x20) return abort(kReadOnly);
  if (command != 0x40) return abort(kNoSuchCommand);
  const std::uint32_t index = question.data[1] | std::uint32_t{question.data[2]} << 8;
  const auto object = objects_.find(index << 8 | question.data[3]);
  if (object == objects_.end()) {
    return abort(objects_.contains(index << 8) ? kNoSuchSubIndex : kNoSuchObject);
  }
  const auto& [value, bytes] = object->second;
  reply.data[0] = static_cast<std::uint8_t>(0x43 | (4 - bytes) << 2);
  PutBytes(reply, 4, bytes, value);
  send_(reply);
}

std::int64_t EncoderNode::CountAt(double angle) const {
  const double turns = angle / (2.0 * std::numbers::pi);
  const std::int64_t shown =
      encoder_.zero + encoder_.sense * std::llround(turns * encoder_.counts_per_turn);
  const std::int64_t count = (shown % encoder_.range + encoder_.range) % encoder_.range;
  return encoder_.is_signed && 2 * count >= encoder_.range ? count - encoder_.range : count;
}

void EncoderNode::Sync(std::optional<double> angle) {
  if (angle) {
    // Continuous where the angle passes pi.
    shaft_ += std::remainder(*angle - shaft_, 2.0 * std::numbers::pi);
    count_ = CountAt(shaft_);
    Put(0x6004, 0, static_cast<std::uint32_t>(count_), 4);
  }
  if (trouble_ == angle.has_value()) Say(!angle);
  if (state_ != State::kOperational) return;
  const std::uint64_t mask = (std::uint64_t{1} << encoder_.bits) - 1;
  const int last_bit = encoder_.at_bit + encoder_.bits - 1;
  CanFrame frame = FrameOf(0x80 + 0x100 * static_cast<std::uint32_t>(encoder_.tpdo), encoder_.node,
                           last_bit / 8 + 1);
  PutBytes(frame, 0, frame.size, (static_cast<std::uint64_t>(count_) & mask) << encoder_.at_bit);
  send_(frame);
}

void EncoderNode::Say(bool trouble) {
  trouble_ = trouble;
  Put(0x1001, 0, trouble ? 1 : 0, 1);
  if (state_ == State::kStopped || state_ == State::kBooting) return;
  CanFrame frame = FrameOf(0x80, encoder_.node, 8);
  PutBytes(frame, 0, 2, trouble ? kHardwareTrouble : 0);
  frame.data[2] = trouble ? 1 : 0;
  send_(frame);
}

}  // namespace abbe::rig
