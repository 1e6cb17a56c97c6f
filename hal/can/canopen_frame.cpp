#include "hal/can/canopen_frame.h"

#include <fmt/format.h>

#include <algorithm>

namespace abbe::hal {
namespace {

constexpr int kLastNode = 127;

// The node of a frame whose identifier is `base` + node and that has `size` bytes or more.
std::optional<int> NodeOf(const CanFrame& frame, std::uint32_t base, int size) {
  if (frame.extended || frame.remote || frame.size < size) return {};
  if (frame.id <= base || frame.id > base + kLastNode) return {};
  return static_cast<int>(frame.id - base);
}

std::string_view ClassOf(std::uint16_t code) {
  switch (code >> 12) {
    case 0x2:
      return "current";
    case 0x3:
      return "voltage";
    case 0x4:
      return "temperature";
    case 0x5:
      return "hardware";
    case 0x6:
      return "software";
    case 0x7:
      return "additional module";
    case 0x8:
      return (code & 0x0F00) == 0x0100 ? "communication" : "monitoring";
    case 0x9:
      return "external error";
    case 0xF:
      return (code & 0x0F00) == 0x0F00 ? "of the maker" : "additional function";
    default:
      return "general";
  }
}

}  // namespace

CanFrame NmtFrame(NmtCommand command, int node) {
  CanFrame frame{.id = kNmtId, .size = 2};
  frame.data = {static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(node)};
  return frame;
}

CanFrame SyncFrame() { return {.id = kSyncId}; }

CanFrame HeartbeatFrame(int node, NmtState state) {
  CanFrame frame{.id = kHeartbeatBase + node, .size = 1};
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

CanFrame EmergencyFrame(int node, std::uint16_t code, std::uint8_t error_register) {
  CanFrame frame{.id = kEmergencyBase + node, .size = 8};
  PutBits(frame, 0, 16, code);
  frame.data[2] = error_register;
  return frame;
}

CanFrame SdoReadFrame(int node, std::uint16_t index, std::uint8_t sub) {
  CanFrame frame{.id = kSdoBase + node, .size = 8};
  frame.data[0] = 0x40;
  PutBits(frame, 8, 16, index);
  frame.data[3] = sub;
  return frame;
}

std::optional<Heartbeat> HeartbeatOf(const CanFrame& frame) {
  const auto node = NodeOf(frame, kHeartbeatBase, 1);
  if (!node) return {};
  return Heartbeat{*node, static_cast<NmtState>(frame.data[0] & 0x7F)};
}

std::optional<Emergency> EmergencyOf(const CanFrame& frame) {
  const auto node = NodeOf(frame, kEmergencyBase, 3);
  if (!node) return {};
  return Emergency{*node, static_cast<std::uint16_t>(*TakeBits(frame, 0, 16, false)),
                   frame.data[2]};
}

std::string EmergencyText(const Emergency& emergency) {
  return fmt::format("emergency {:04X}h ({}), error register {:02X}h", emergency.code,
                     ClassOf(emergency.code), emergency.error_register);
}

std::optional<SdoReply> SdoReplyOf(const CanFrame& frame) {
  const auto node = NodeOf(frame, kSdoReplyBase, 8);
  if (!node) return {};
  SdoReply reply{
      *node, static_cast<std::uint16_t>(*TakeBits(frame, 8, 16, false)), frame.data[3], {}};
  const std::uint8_t command = frame.data[0];
  const bool refused = command == 0x80;
  const bool expedited = (command & 0xE2) == 0x42;
  if (!refused && (command & 0xE0) != 0x40) return {};  // the answer to something else
  if (expedited) {
    const int size = (command & 1) != 0 ? 4 - ((command >> 2) & 3) : 4;
    reply.value = static_cast<std::uint32_t>(*TakeBits(frame, 32, 8 * size, false));
  }
  return reply;
}

std::optional<std::int64_t> TakeBits(const CanFrame& frame, int at, int bits, bool is_signed) {
  if (at + bits > 8 * frame.size) return {};
  std::uint64_t all = 0;
  for (std::size_t i = frame.data.size(); i-- > 0;) all = all << 8 | frame.data[i];
  const std::uint64_t one_above = std::uint64_t{1} << bits;
  const std::int64_t number = all >> at & (one_above - 1);
  const bool negative = is_signed && (number >> (bits - 1)) != 0;
  return negative ? number - static_cast<std::int64_t>(one_above) : number;
}

void PutBits(CanFrame& frame, int at, int bits, std::int64_t number) {
  for (int i = 0; i < bits; ++i) {
    std::uint8_t& byte = frame.data[(at + i) / 8];
    const auto mask = static_cast<std::uint8_t>(1 << (at + i) % 8);
    byte = static_cast<std::uint8_t>((number >> i & 1) != 0 ? byte | mask : byte & ~mask);
  }
  frame.size = std::max(frame.size, static_cast<std::uint8_t>((at + bits + 7) / 8));
}

}  // namespace abbe::hal
