#include "hal/can/canopen_frame.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <initializer_list>

namespace abbe::hal {
namespace canopen_frame_test {

CanFrame Frame(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  CanFrame frame{.id = id, .size = static_cast<std::uint8_t>(data.size())};
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

// Byte for byte as CiA 301 prints them.
TEST(CanopenFrame, AMasterSpeaksAsTheStandardSays) {
  EXPECT_EQ(NmtFrame(NmtCommand::kStart, 2), Frame(0x000, {0x01, 0x02}));
  EXPECT_EQ(NmtFrame(NmtCommand::kReset, 0), Frame(0x000, {0x81, 0x00}));
  EXPECT_EQ(SyncFrame(), Frame(0x080, {}));
  EXPECT_EQ(SdoReadFrame(3, 0x6002, 0), Frame(0x603, {0x40, 0x02, 0x60, 0, 0, 0, 0, 0}));
  EXPECT_EQ(TpdoId(1, 1), 0x181u);
  EXPECT_EQ(TpdoId(4, 127), 0x4FFu);
}

TEST(CanopenFrame, ANodeIsUnderstood) {
  const auto heartbeat = HeartbeatOf(Frame(0x705, {0x7F}));
  ASSERT_TRUE(heartbeat.has_value());
  EXPECT_EQ(heartbeat->node, 5);
  EXPECT_EQ(heartbeat->state, NmtState::kPreOperational);
  EXPECT_FALSE(HeartbeatOf(Frame(0x700, {0x05})).has_value());
  EXPECT_FALSE(HeartbeatOf(Frame(0x705, {})).has_value());

  const auto emergency = EmergencyOf(Frame(0x081, {0x10, 0x31, 0x05, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(emergency.has_value());
  EXPECT_EQ(EmergencyText(*emergency), "emergency 3110h (voltage), error register 05h");
  EXPECT_FALSE(EmergencyOf(SyncFrame()).has_value());
}

TEST(CanopenFrame, AnswersOfEverySizeAndARefusal) {
  const auto value = [](std::initializer_list<std::uint8_t> data) {
    return SdoReplyOf(Frame(0x582, data)).value().value;
  };
  EXPECT_EQ(value({0x43, 0x02, 0x60, 0, 0x78, 0x56, 0x34, 0x12}), 0x12345678u);
  EXPECT_EQ(value({0x4B, 0x00, 0x60, 0, 0x04, 0x01, 0xFF, 0xFF}), 0x0104u);
  EXPECT_EQ(value({0x4F, 0x00, 0x60, 0, 0x04, 0xFF, 0xFF, 0xFF}), 0x04u);
  EXPECT_EQ(value({0x42, 0x01, 0x60, 0, 0x00, 0x10, 0x00, 0x00}), 0x1000u);
  EXPECT_FALSE(value({0x80, 0x01, 0x60, 0, 0, 0, 2, 6}).has_value());
  EXPECT_FALSE(value({0x41, 0x08, 0x10, 0, 0x20, 0, 0, 0}).has_value());  // a long text
  // The confirmation of a write, and a frame cut short.
  EXPECT_FALSE(SdoReplyOf(Frame(0x582, {0x60, 0, 0x60, 0, 0, 0, 0, 0})).has_value());
  EXPECT_FALSE(SdoReplyOf(Frame(0x582, {0x43, 0x02, 0x60})).has_value());
}

TEST(CanopenFrame, NumbersLieLittleEndian) {
  const CanFrame pdo = Frame(0x181, {0xFF, 0x34, 0x12, 0x80, 0xFF});
  EXPECT_EQ(TakeBits(pdo, 8, 16, false), 0x1234);
  EXPECT_EQ(TakeBits(pdo, 24, 8, true), -128);
  EXPECT_EQ(TakeBits(pdo, 12, 8, false), 0x23);
  EXPECT_EQ(TakeBits(pdo, 31, 9, true), -1);
  EXPECT_FALSE(TakeBits(pdo, 33, 8, false).has_value());
}

RC_GTEST_PROP(CanopenFrame, WhatIsPutIsTaken, ()) {
  const int bits = *rc::gen::inRange(1, 49);
  const int at = *rc::gen::inRange(0, 65 - bits);
  const bool is_signed = *rc::gen::arbitrary<bool>();
  const std::int64_t most = std::int64_t{1} << bits;
  const std::int64_t low = is_signed ? -most / 2 : 0;
  const auto number = *rc::gen::inRange<std::int64_t>(low, low + most);
  CanFrame frame = Frame(1, {});
  frame.data.fill(*rc::gen::arbitrary<std::uint8_t>());
  const CanFrame before = frame;
  PutBits(frame, at, bits, number);
  RC_ASSERT(TakeBits(frame, at, bits, is_signed) == number);
  CanFrame whole = frame, whole_before = before;
  whole.size = whole_before.size = 8;
  if (at > 0 && at <= 48)
    RC_ASSERT(TakeBits(whole, 0, at, false) == TakeBits(whole_before, 0, at, false));
}

}  // namespace canopen_frame_test
}  // namespace abbe::hal
