// CANopen as frames: those of a master, those of a node, and numbers in the bits of a PDO; no
// bus, no clock. Masters and tests speak with it; the virtual rig has its own.
//
//   bus.Send(NmtFrame(NmtCommand::kStart, 2));
//   if (const auto reply = SdoReplyOf(frame)) values[reply->node] = reply->value;
//
// Units: none; bits and bytes.
// Failure: none; a frame of another kind gives nothing.
// Source: CiA 301 (object identifiers, NMT, SYNC, EMCY, SDO, heartbeat), CiA 406 (encoders). All
// integers on the wire are little-endian. Node ids are 1 to 127.
// Validity: SDO replies of up to four bytes (expedited transfer).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/can/can_bus.h"

namespace abbe::hal {

enum class NmtCommand : std::uint8_t {
  kStart = 1,
  kStop = 2,
  kEnterPreOperational = 128,
  kReset = 129,
};
enum class NmtState : std::uint8_t {
  kBootUp = 0,  // sent once, when the node has started
  kStopped = 4,
  kOperational = 5,
  kPreOperational = 127,
};

inline constexpr std::uint32_t kNmtId = 0x000, kSyncId = 0x080;
inline constexpr std::uint32_t kEmergencyBase = 0x080, kSdoReplyBase = 0x580, kSdoBase = 0x600,
                               kHeartbeatBase = 0x700;

// The identifier of transmit PDO 1 to 4 as the profile presets it: 181h for PDO 1 of node 1.
constexpr std::uint32_t TpdoId(int tpdo, int node) { return 0x080 + 0x100 * tpdo + node; }

CanFrame NmtFrame(NmtCommand command, int node);  // node 0: all
// Without a counter.
CanFrame SyncFrame();
// As a node sends it.
CanFrame HeartbeatFrame(int node, NmtState state);
// `code` 0: the error is over.
CanFrame EmergencyFrame(int node, std::uint16_t code, std::uint8_t error_register);
// Asks for an object of the node.
CanFrame SdoReadFrame(int node, std::uint16_t index, std::uint8_t sub);

struct Heartbeat {
  int node;
  NmtState state;
};
// Nothing for another frame.
std::optional<Heartbeat> HeartbeatOf(const CanFrame& frame);

struct Emergency {
  int node;
  std::uint16_t code;           // 0: the error is over
  std::uint8_t error_register;  // object 1001h
};
// Nothing for another frame.
std::optional<Emergency> EmergencyOf(const CanFrame& frame);
// "emergency 3110h (voltage), error register 04h".
std::string EmergencyText(const Emergency& emergency);

struct SdoReply {
  int node;
  std::uint16_t index;
  std::uint8_t sub;
  std::optional<std::uint32_t> value;  // empty: refused, or longer than four bytes
};
// The answer to a read request. A reply that does not state its size counts as four bytes.
std::optional<SdoReply> SdoReplyOf(const CanFrame& frame);

// The number in `bits` (1 to 48) bits from bit `at` of the data, bit 0 the lowest of byte 0;
// nothing when the frame is too short.
std::optional<std::int64_t> TakeBits(const CanFrame& frame, int at, int bits, bool is_signed);
// Stores it there and makes the frame long enough.
void PutBits(CanFrame& frame, int at, int bits, std::int64_t number);

}  // namespace abbe::hal
