// Modbus requests as bytes, and the check of a reply; no socket, no clock.
//
// The library returns a TCP reply without checking its unit id, and its raw requests carry no
// transaction number, so the client frames by itself and checks everything a reply must repeat:
// transaction, protocol, length, unit, function, count (TCP); unit, function, count, CRC (serial).
// Units: none; bytes.
// Failure: none; ModbusReply::wrong says why a reply is none.
// Source: Modbus application protocol V1.1b3, sections 6.3, 6.4, 6.6, 6.21 and 7; Modbus messaging
// on TCP/IP V1.0b, section 3.1.3; Modbus over serial line V1.02, section 2.5.1.2 (CRC).
// Validity: functions 3, 4, 6 and 43 only.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace abbe::hal {

enum class ModbusFraming { kTcp, kRtu };

// Function codes, and the type of kWhoAreYou that reads the device identification.
inline constexpr int kReadHolding = 3, kReadInput = 4, kWriteOne = 6, kWriteMany = 16;
inline constexpr int kWhoAreYou = 43, kDeviceIdentification = 14;
inline constexpr std::size_t kTcpHead = 6;  // transaction, protocol, length; the unit follows
inline constexpr std::size_t kCrcSize = 2;

struct ModbusRequest {
  int unit = 1;
  int function = 4;  // 3 and 4: read `value` registers; 6: write `value`; 43: who are you
  int address = 0;
  int value = 1;  // the count or the word

  std::string Text() const;  // "read 5 input registers from 0"
};

inline constexpr std::size_t kLongestFrame = 260;

struct ModbusFrame {
  std::array<std::uint8_t, 12> bytes{};
  std::size_t size = 0;
  std::span<const std::uint8_t> view() const { return {bytes.data(), size}; }
};

// The bytes on the wire; `transaction` for TCP only.
ModbusFrame Encode(const ModbusRequest& request, ModbusFraming framing, std::uint16_t transaction);

// The length of a reply by its first bytes; more than `got.size()` while bytes are missing, never
// more than kLongestFrame.
std::size_t ReplyLength(std::span<const std::uint8_t> got, ModbusFraming framing);

struct ModbusReply {
  std::string wrong;  // why the bytes are not a reply to the request; empty when well
  int exception = 0;  // the device's refusal, 0 for none
  std::span<const std::uint8_t> words;    // the registers read, two bytes each, high byte first
  std::span<const std::uint8_t> objects;  // of function 43: id, length, text; and so on
};

// Takes a complete reply apart. `words` points into `reply`.
ModbusReply CheckReply(const ModbusRequest& request, ModbusFraming framing,
                       std::uint16_t transaction, std::span<const std::uint8_t> reply);

// "exception 2 (illegal data address)", and what to do about it.
std::string ExceptionText(int exception);
// What to do about it.
std::string ExceptionRemedy(int exception);

// The identification of a device (function 43, MEI type 14): its objects, "vendor product
// revision", without characters that are not printable ASCII.
std::string IdentityText(std::span<const std::uint8_t> objects);

// Polynomial A001h, as section 2.5.1.2 has it.
std::uint16_t Crc16(std::span<const std::uint8_t> bytes);

}  // namespace abbe::hal
