// `hal/modbus/modbus_frame.h`: what a client takes for the reply to its request. The input: framing
// and function, address, value and transaction (2 bytes each), then the bytes of the reply; the
// last two of a serial one are replaced by their CRC where the lowest bit but one says so.
#include <algorithm>
#include <vector>

#include "fuzz/target.h"
#include "hal/modbus/modbus_frame.h"

namespace abbe::fuzz::modbus_reply {

constexpr std::size_t kHead = 7;

int Word(Bytes bytes, std::size_t at) { return bytes[at] << 8 | bytes[at + 1]; }

void Read(Bytes bytes) {
  if (bytes.size() < kHead) return;
  const auto framing = (bytes[0] & 1) != 0 ? hal::ModbusFraming::kRtu : hal::ModbusFraming::kTcp;
  const int function = bytes[0] >> 2 & 7;
  hal::ModbusRequest request{.unit = 1, .function = 3 + function % 2, .address = Word(bytes, 1)};
  request.value = 1 + Word(bytes, 3) % 125;
  if (function > 5) {
    request.function = 6;
    request.value = Word(bytes, 3);
  }
  const auto transaction = static_cast<std::uint16_t>(Word(bytes, 5));
  Require(hal::Encode(request, framing, transaction).size <= 12, "a request has its size");
  std::vector<std::uint8_t> reply(bytes.begin() + kHead, bytes.end());
  if ((bytes[0] & 2) != 0 && reply.size() > 2) {
    const std::uint16_t crc = hal::Crc16(Bytes(reply).first(reply.size() - 2));
    reply[reply.size() - 2] = static_cast<std::uint8_t>(crc & 0xFF);
    reply[reply.size() - 1] = static_cast<std::uint8_t>(crc >> 8);
  }
  // As a client reads it: more bytes until there are as many as they themselves say.
  std::size_t have = 0;
  while (true) {
    const std::size_t length = hal::ReplyLength(Bytes(reply).first(have), framing);
    Require(length <= hal::kLongestFrame, "no reply is longer than the longest frame");
    if (length <= have) break;
    if (length > reply.size()) return;
    have = length;
  }
  const auto taken = hal::CheckReply(request, framing, transaction, Bytes(reply).first(have));
  if (!taken.wrong.empty() || taken.exception != 0) {
    Require(taken.words.empty(), "a reply that is refused has no registers");
  } else if (request.function != 6) {
    Require(taken.words.size() == 2 * static_cast<std::size_t>(request.value),
            "as many registers as were asked for");
  }
}

}  // namespace abbe::fuzz::modbus_reply
