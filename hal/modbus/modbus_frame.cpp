#include "hal/modbus/modbus_frame.h"

#include <fmt/format.h>

#include <algorithm>

namespace abbe::hal {
namespace {

constexpr std::size_t kIdentityHead = 6;  // type, code, conformity, more, next, count
constexpr int kRefusalBit = 0x80;

int Word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] << 8 | bytes[at + 1];
}

bool Reads(int function) { return function == kReadHolding || function == kReadInput; }

// The length of an identification from its function on, by what came of it so far: at least one
// byte more than `body` while bytes are missing.
std::size_t IdentityLength(std::span<const std::uint8_t> body) {
  std::size_t length = 1 + kIdentityHead;
  for (int left = body.size() < length ? 0 : body[length - 1]; left > 0; --left) {
    if (body.size() < length + 2) return length + 2;
    length += 2U + body[length + 1];
  }
  return length;
}

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
  } else if (request.function == kWhoAreYou) {
    if (body.size() < 2 + kIdentityHead || body[2] != kDeviceIdentification ||
        IdentityLength(body.subspan(1)) != body.size() - 1) {
      reply.wrong = "a malformed identification";
    } else {
      reply.objects = body.subspan(2 + kIdentityHead);
    }
  } else if (Reads(request.function)) {
    const std::size_t wanted = 2 * request.value;
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
  if (function == kWhoAreYou) return "say who you are";
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
  const bool asks_who = request.function == kWhoAreYou;
  if (framing == ModbusFraming::kTcp) {
    put_word(transaction);
    put_word(0);                 // protocol: Modbus
    put_word(asks_who ? 5 : 6);  // bytes that follow
  }
  put(request.unit);
  put(request.function);
  if (asks_who) {
    put(kDeviceIdentification);
    put(1);  // the basic objects,
    put(0);  // from the first on
  } else {
    put_word(request.address);
    put_word(request.value);
  }
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
    return std::min(kTcpHead + Word(got, 4), kLongestFrame);
  }
  constexpr std::size_t kShortest = 5;  // an exception: unit, function, code, CRC
  if (got.size() >= 2 && got[1] == kWhoAreYou) {
    return std::min(1 + IdentityLength(got.subspan(1)) + kCrcSize, kLongestFrame);
  }
  if (got.size() < 3 || !Reads(got[1])) {
    return got.size() >= 2 && got[1] == kWriteOne ? 8 : kShortest;
  }
  return std::min(3 + got[2] + kCrcSize, kLongestFrame);
}

ModbusReply CheckReply(const ModbusRequest& request, ModbusFraming framing,
                       std::uint16_t transaction, std::span<const std::uint8_t> reply) {
  if (framing == ModbusFraming::kTcp) {
    if (reply.size() < kTcpHead + 3) return {"a reply that is too short", 0, {}, {}};
    if (Word(reply, 2) != 0) return {"bytes that are not Modbus", 0, {}, {}};
    if (Word(reply, 0) != transaction) return {"a reply to another request", 0, {}, {}};
    return CheckBody(request, reply.subspan(kTcpHead));
  }
  if (reply.size() < 3 + kCrcSize) return {"a reply that is too short", 0, {}, {}};
  const auto body = reply.first(reply.size() - kCrcSize);
  const std::uint16_t crc = Crc16(body);
  if (reply[body.size()] != (crc & 0xFF) || reply[body.size() + 1] != crc >> 8) {
    return {"a reply with a wrong CRC", 0, {}, {}};
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
  const std::size_t at = exception;
  return at < kNames.size() && !kNames[at].empty()
             ? fmt::format("exception {} ({})", exception, kNames[at])
             : fmt::format("exception {}", exception);
}

std::string ExceptionRemedy(int exception) {
  switch (exception) {
    case 1:
      return "it does not know this function: set `function` of the block to the other of "
             "\"input\" and \"holding\"";
    case 2:
      return "the block reaches beyond its registers: check `address`, `count` and `address_base`";
    case 3:
      return "it does not take this number: check `count`, or what is to be written";
    case 4:
      return "it has failed: look at its own display or log, and switch it off and on";
    case 5:
      return "it is still at work on it: try again in a while";
    case 6:
      return "it is busy, with its program or another client: try again when it is done";
    case 10:
    case 11:
      return "its gateway does not reach it: check `unit`, that it is on, and the line behind the "
             "gateway";
    default:
      return "its manual says what this means";
  }
}

std::string IdentityText(std::span<const std::uint8_t> objects) {
  std::string text;
  while (objects.size() >= 2 && objects.size() >= 2U + objects[1]) {
    if (!text.empty()) text += ' ';
    for (const std::uint8_t letter : objects.subspan(2, objects[1])) {
      if (letter >= ' ' && letter <= '~') text += static_cast<char>(letter);
    }
    objects = objects.subspan(2U + objects[1]);
  }
  return text;
}

}  // namespace abbe::hal
