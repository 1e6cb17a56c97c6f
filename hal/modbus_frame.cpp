#include "hal/modbus_frame.h"

#include <fmt/format.h>

#include <algorithm>

namespace abbe::hal {
namespace {

constexpr int kRefusalBit = 0x80;
constexpr std::size_t kTcpHead = 6;  // transaction, protocol, length; the unit follows
constexpr std::size_t kCrcSize = 2;

int Word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] << 8 | bytes[at + 1];
}

bool Reads(int function) { return function == kReadHolding || function == kReadInput; }

// The part of a reply that both framings share: unit, function, data.
ModbusReply CheckBody(const ModbusRequest& request, std::span<const std::uint8_t> body) {
  ModbusReply reply;
  if (body.size() < 3) {
    reply.wrong = "a reply that is too short";
  } else if (body[0] != request.unit) {
    reply.wrong = fmt::format("a reply from unit {} instead of {}", body[0], request.unit);
  } else if (body[1] == (request.function | kRefusalBit)) {
    if (body.size() != 3 || body[2] == 0) {
      reply.wrong = "a malformed exception";
    } else {
      reply.exception = body[2];
    }
  } else if (body[1] != request.function) {
    reply.wrong = fmt::format("a reply to function {} instead of {}", body[1], request.function);
  } else if (Reads(request.function)) {
    const auto wanted = static_cast<std::size_t>(2 * request.value);
    if (body[2] != wanted || body.size() != 3 + wanted) {
      reply.wrong = fmt::format("{} bytes of registers instead of {}", body[2], wanted);
    } else {
      reply.words = body.subspan(3);
    }
  } else if (body.size() != 6 || Word(body, 2) != request.address ||
             Word(body, 4) != request.value) {
    reply.wrong = "an echo that differs from what was written";
  }
  return reply;
}

}  // namespace

std::string ModbusRequest::Text() const {
  if (function == kWriteOne) return fmt::format("write {} to holding register {}", value, address);
  return fmt::format("read {} {} register{} from {}", value,
                     function == kReadInput ? "input" : "holding", value == 1 ? "" : "s", address);
}

std::uint16_t Crc16(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

ModbusFrame Encode(const ModbusRequest& request, ModbusFraming framing, std::uint16_t transaction) {
  ModbusFrame frame;
  const auto put = [&](int byte) {
    frame.bytes[frame.size++] = static_cast<std::uint8_t>(byte & 0xFF);
  };
  const auto put_word = [&](int word) {
    put(word >> 8);
    put(word);
  };
  if (framing == ModbusFraming::kTcp) {
    put_word(transaction);
    put_word(0);  // protocol: Modbus
    put_word(6);  // bytes that follow
  }
  put(request.unit);
  put(request.function);
  put_word(request.address);
  put_word(request.value);
  if (framing == ModbusFraming::kRtu) {
    const std::uint16_t crc = Crc16(frame.view());
    put(crc);  // low byte first
    put(crc >> 8);
  }
  return frame;
}

std::size_t ReplyLength(std::span<const std::uint8_t> got, ModbusFraming framing) {
  if (framing == ModbusFraming::kTcp) {
    if (got.size() < kTcpHead) return kTcpHead;
    return std::min(kTcpHead + static_cast<std::size_t>(Word(got, 4)), kLongestFrame);
  }
  constexpr std::size_t kShortest = 5;  // an exception: unit, function, code, CRC
  if (got.size() < 3 || !Reads(got[1])) {
    return got.size() >= 2 && got[1] == kWriteOne ? 8 : kShortest;
  }
  return std::min(3 + got[2] + kCrcSize, kLongestFrame);
}

ModbusReply CheckReply(const ModbusRequest& request, ModbusFraming framing,
                       std::uint16_t transaction, std::span<const std::uint8_t> reply) {
  if (framing == ModbusFraming::kTcp) {
    if (reply.size() < kTcpHead + 3) return {"a reply that is too short", 0, {}};
    if (Word(reply, 2) != 0) return {"bytes that are not Modbus", 0, {}};
    if (Word(reply, 0) != transaction) return {"a reply to another request", 0, {}};
    return CheckBody(request, reply.subspan(kTcpHead));
  }
  if (reply.size() < 3 + kCrcSize) return {"a reply that is too short", 0, {}};
  const auto body = reply.first(reply.size() - kCrcSize);
  const std::uint16_t crc = Crc16(body);
  if (reply[body.size()] != (crc & 0xFF) || reply[body.size() + 1] != crc >> 8) {
    return {"a reply with a wrong CRC", 0, {}};
  }
  return CheckBody(request, body);
}

std::string ExceptionText(int exception) {
  constexpr std::array<std::string_view, 12> kNames = {"",
                                                       "illegal function",
                                                       "illegal data address",
                                                       "illegal data value",
                                                       "device failure",
                                                       "acknowledge, not ready yet",
                                                       "busy",
                                                       "negative acknowledge",
                                                       "memory parity error",
                                                       "",
                                                       "gateway path unavailable",
                                                       "gateway target does not answer"};
  const auto at = static_cast<std::size_t>(exception);
  return at < kNames.size() && !kNames[at].empty()
             ? fmt::format("exception {} ({})", exception, kNames[at])
             : fmt::format("exception {}", exception);
}

}  // namespace abbe::hal
