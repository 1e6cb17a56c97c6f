// Frames are those printed in the Modbus application protocol V1.1b3 (the examples of
// sections 6.3, 6.4 and 6.6); the CRC value is the published check value of CRC-16/MODBUS.
#include "hal/modbus/modbus_frame.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::hal {
namespace modbus_frame_test {

using Bytes = std::vector<std::uint8_t>;

Bytes Encoded(const ModbusRequest& request, ModbusFraming framing, std::uint16_t transaction = 0) {
  const ModbusFrame frame = Encode(request, framing, transaction);
  return {frame.view().begin(), frame.view().end()};
}

constexpr ModbusRequest kRead{0x11, 3, 0x6B, 3};
const Bytes kReadReply{0x15, 0x01, 0, 0, 0, 9, 0x11, 3, 6, 0x02, 0x2B, 0x00, 0x00, 0x00, 0x64};

Bytes WithCrc(Bytes body) {
  const std::uint16_t crc = Crc16(body);
  body.push_back(crc & 0xFF);
  body.push_back(crc >> 8);
  return body;
}

TEST(ModbusFrame, CrcHasThePublishedCheckValue) {
  constexpr std::string_view kDigits = "123456789";
  EXPECT_EQ(Crc16(Bytes(kDigits.begin(), kDigits.end())), 0x4B37);
}

TEST(ModbusFrame, EncodesTheExamplesOfTheProtocol) {
  EXPECT_EQ(Encoded(kRead, ModbusFraming::kTcp, 0x1501),
            (Bytes{0x15, 0x01, 0, 0, 0, 6, 0x11, 3, 0x00, 0x6B, 0x00, 0x03}));
  EXPECT_EQ(Encoded({1, 6, 1, 3}, ModbusFraming::kTcp, 2),
            (Bytes{0, 2, 0, 0, 0, 6, 1, 6, 0, 1, 0, 3}));
  // The serial example that is found in every manual: 01 03 00 00 00 0A C5 CD.
  EXPECT_EQ(Encoded({1, 3, 0, 10}, ModbusFraming::kRtu), (Bytes{1, 3, 0, 0, 0, 10, 0xC5, 0xCD}));
}

TEST(ModbusFrame, KnowsTheLengthOfAReplyAsItComes) {
  for (std::size_t n = 0; n < kReadReply.size(); ++n) {
    const std::span<const std::uint8_t> got(kReadReply.data(), n);
    EXPECT_EQ(ReplyLength(got, ModbusFraming::kTcp), n < 6 ? 6 : kReadReply.size()) << n;
  }
  const Bytes serial = WithCrc({0x11, 3, 6, 0x02, 0x2B, 0, 0, 0, 0x64});
  for (std::size_t n = 3; n <= serial.size(); ++n) {
    EXPECT_EQ(ReplyLength(std::span(serial.data(), n), ModbusFraming::kRtu), serial.size());
  }
  EXPECT_EQ(ReplyLength(Bytes{0x11, 0x83}, ModbusFraming::kRtu), 5u);
  EXPECT_EQ(ReplyLength(Bytes{0x11, 6, 0}, ModbusFraming::kRtu), 8u);
  EXPECT_EQ(ReplyLength(Bytes{0, 0, 0, 0, 0xFF, 0xFF, 1}, ModbusFraming::kTcp), kLongestFrame);
}

TEST(ModbusFrame, TakesTheReplyApart) {
  const ModbusReply reply = CheckReply(kRead, ModbusFraming::kTcp, 0x1501, kReadReply);
  EXPECT_EQ(reply.wrong, "");
  EXPECT_EQ(reply.exception, 0);
  EXPECT_EQ(Bytes(reply.words.begin(), reply.words.end()), (Bytes{0x02, 0x2B, 0, 0, 0, 0x64}));
}

TEST(ModbusFrame, RefusesAReplyThatDiffersInAnyByteItMustRepeat) {
  // All but the six bytes of registers.
  for (std::size_t at = 0; at < 9; ++at) {
    Bytes altered = kReadReply;
    altered[at] ^= 0x04;
    const std::size_t length = ReplyLength(altered, ModbusFraming::kTcp);
    if (length > altered.size()) continue;  // never complete: a time-out
    altered.resize(length);
    EXPECT_NE(CheckReply(kRead, ModbusFraming::kTcp, 0x1501, altered).wrong, "") << at;
  }
  EXPECT_EQ(CheckReply(kRead, ModbusFraming::kTcp, 0x1500, kReadReply).wrong,
            "a reply to another request");
  EXPECT_EQ(CheckReply({0x12, 3, 0x6B, 3}, ModbusFraming::kTcp, 0x1501, kReadReply).wrong,
            "a reply from unit 17 instead of 18");
}

TEST(ModbusFrame, ASerialReplyWithAnyBitWrongIsRefused) {
  const Bytes good = WithCrc({0x11, 3, 6, 0x02, 0x2B, 0, 0, 0, 0x64});
  ASSERT_EQ(CheckReply(kRead, ModbusFraming::kRtu, 0, good).wrong, "");
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes altered = good;
    altered[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
    EXPECT_NE(CheckReply(kRead, ModbusFraming::kRtu, 0, altered).wrong, "") << bit;
  }
}

TEST(ModbusFrame, TellsAnExceptionFromAFault) {
  const Bytes refusal{0, 1, 0, 0, 0, 3, 0x11, 0x83, 2};
  const ModbusReply reply = CheckReply(kRead, ModbusFraming::kTcp, 1, refusal);
  EXPECT_EQ(reply.wrong, "");
  EXPECT_EQ(reply.exception, 2);
  EXPECT_EQ(ExceptionText(2), "exception 2 (illegal data address)");
  EXPECT_EQ(ExceptionText(99), "exception 99");
}

TEST(ModbusFrame, AWrittenWordMustComeBack) {
  const ModbusRequest write{1, 6, 1, 3};
  EXPECT_EQ(
      CheckReply(write, ModbusFraming::kTcp, 2, Bytes{0, 2, 0, 0, 0, 6, 1, 6, 0, 1, 0, 3}).wrong,
      "");
  EXPECT_EQ(
      CheckReply(write, ModbusFraming::kTcp, 2, Bytes{0, 2, 0, 0, 0, 6, 1, 6, 0, 1, 0, 4}).wrong,
      "an echo that differs from what was written");
}

// The example of section 6.21: "Company identification", "Product code XX", "V2.11".
TEST(ModbusFrame, AsksADeviceWhoItIs) {
  constexpr ModbusRequest kWho{1, 43, 0, 0};
  EXPECT_EQ(Encoded(kWho, ModbusFraming::kTcp, 7), (Bytes{0, 7, 0, 0, 0, 5, 1, 0x2B, 0x0E, 1, 0}));
  Bytes body{1, 0x2B, 0x0E, 1, 1, 0, 0, 3};
  const std::vector<std::string> said{"Company identification", "Product code XX", "V2.11"};
  for (std::size_t id = 0; id < said.size(); ++id) {
    body.push_back(static_cast<std::uint8_t>(id));
    body.push_back(static_cast<std::uint8_t>(said[id].size()));
    body.insert(body.end(), said[id].begin(), said[id].end());
  }
  const Bytes serial = WithCrc(body);
  for (std::size_t n = 0; n < serial.size(); ++n) {
    EXPECT_GT(ReplyLength(std::span(serial.data(), n), ModbusFraming::kRtu), n);
  }
  EXPECT_EQ(ReplyLength(serial, ModbusFraming::kRtu), serial.size());
  const ModbusReply reply = CheckReply(kWho, ModbusFraming::kRtu, 0, serial);
  EXPECT_EQ(reply.wrong, "");
  EXPECT_EQ(IdentityText(reply.objects), "Company identification Product code XX V2.11");
  // Whatever is cut off or left over is no identification.
  for (std::size_t cut = 1; cut < body.size() - 2; ++cut) {
    const Bytes part = WithCrc(Bytes(body.begin(), body.end() - static_cast<long>(cut)));
    EXPECT_NE(CheckReply(kWho, ModbusFraming::kRtu, 0, part).wrong, "") << cut;
  }
  EXPECT_EQ(IdentityText(Bytes{0, 5, 'a', '\n', 0x1B, 0xFF, 'b'}), "ab");
}

TEST(ModbusFrame, EveryExceptionHasARemedyOfItsOwn) {
  std::set<std::string> remedies;
  for (const int exception : {1, 2, 3, 4, 5, 6}) {
    const std::string remedy = ExceptionRemedy(exception);
    EXPECT_TRUE(remedies.insert(remedy).second) << remedy;
    EXPECT_EQ(remedy.find("check that it is on"), std::string::npos);
  }
  EXPECT_EQ(ExceptionRemedy(10), ExceptionRemedy(11));
  EXPECT_NE(ExceptionRemedy(6).find("busy"), std::string::npos);
  EXPECT_NE(ExceptionRemedy(77), "");
}

}  // namespace modbus_frame_test
}  // namespace abbe::hal
