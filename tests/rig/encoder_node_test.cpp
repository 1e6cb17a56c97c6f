#include "rig/encoder_node.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "hal/can/canopen_frame.h"

namespace abbe::rig {
namespace encoder_node_test {

constexpr double kTurn = 2.0 * std::numbers::pi;

hal::EncoderSettings Encoder() {
  hal::EncoderSettings encoder;
  encoder.name = "pivot_2_rad";
  encoder.node = 2;
  encoder.counts_per_turn = 65536;
  encoder.range = 65536;
  return encoder;
}

// As candump prints it: "182#0001".
std::string Printed(const hal::CanFrame& frame) {
  std::string text = fmt::format("{:03X}#", frame.id);
  for (std::size_t i = 0; i < frame.size; ++i) text += fmt::format("{:02X}", frame.data[i]);
  return text;
}

hal::CanFrame Frame(std::uint32_t id, const std::vector<std::uint8_t>& data) {
  hal::CanFrame frame{.id = id, .size = static_cast<std::uint8_t>(data.size())};
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

class Node {
 public:
  explicit Node(const hal::EncoderSettings& encoder = Encoder())
      : node(encoder, [this](const hal::CanFrame& frame) { sent.push_back(frame); }) {
    node.Boot();
  }
  // What it has said since the last call.
  std::vector<std::string> Said() {
    std::vector<std::string> said;
    for (const hal::CanFrame& frame : sent) said.push_back(Printed(frame));
    sent.clear();
    return said;
  }
  std::vector<std::string> Answer(std::uint32_t id, const std::vector<std::uint8_t>& data) {
    Said();
    node.Hear(Frame(id, data));
    return Said();
  }
  void Start() { Answer(0x000, {1, 0}); }

  std::vector<hal::CanFrame> sent;
  EncoderNode node;
};

using Frames = std::vector<std::string>;

TEST(EncoderNode, BootsAndObeysTheMasterOfTheNetwork) {
  Node encoder;
  EXPECT_EQ(encoder.Said(), Frames{"702#00"});
  encoder.node.Sync(0.5);
  encoder.node.Beat();
  EXPECT_EQ(encoder.Said(), Frames{"702#7F"});  // pre-operational: no PDO
  EXPECT_EQ(encoder.Answer(0x000, {1, 3}), Frames{});
  encoder.node.Sync(0.5);
  EXPECT_EQ(encoder.Said(), Frames{});  // another was meant
  encoder.Answer(0x000, {1, 2});
  encoder.node.Sync(0.25 * kTurn);
  encoder.node.Beat();
  EXPECT_EQ(encoder.Said(), (Frames{"182#00400000", "702#05"}));
  encoder.Answer(0x000, {2, 0});
  encoder.node.Sync(0.25 * kTurn);
  encoder.node.Beat();
  EXPECT_EQ(encoder.Said(), Frames{"702#04"});
  EXPECT_EQ(encoder.Answer(0x602, {0x40, 0x01, 0x60, 0, 0, 0, 0, 0}), Frames{});
  EXPECT_EQ(encoder.Answer(0x000, {129, 0}), Frames{"702#00"});
  encoder.node.Sync(0.25 * kTurn);
  EXPECT_EQ(encoder.Said(), Frames{});
}

TEST(EncoderNode, TellsWhatItIs) {
  hal::EncoderSettings settings = Encoder();
  settings.range = 16 * 65536;
  settings.serial = 0x12345678;
  Node encoder(settings);
  const auto ask = [&](std::uint8_t low, std::uint8_t high, std::uint8_t sub) {
    return encoder.Answer(0x602, {0x40, low, high, sub, 0, 0, 0, 0}).at(0);
  };
  EXPECT_EQ(ask(0x00, 0x10, 0), "582#4300100096010200");  // encoder, multi-turn
  EXPECT_EQ(ask(0x01, 0x60, 0), "582#4301600000000100");
  EXPECT_EQ(ask(0x02, 0x60, 0), "582#4302600000001000");
  EXPECT_EQ(ask(0x02, 0x65, 0), "582#4B02650010000000");
  EXPECT_EQ(ask(0x18, 0x10, 4), "582#4318100478563412");
  EXPECT_EQ(ask(0x17, 0x10, 0), "582#4B17100064000000");
  EXPECT_EQ(ask(0x00, 0x18, 2), "582#4F00180201000000");
  EXPECT_EQ(ask(0x00, 0x18, 9), "582#8000180911000906");  // no such sub-index
  EXPECT_EQ(ask(0x99, 0x60, 0), "582#8099600000000206");  // no such object
  encoder.node.Sync(0.5 * kTurn);
  EXPECT_EQ(ask(0x04, 0x60, 0), "582#4304600000800000");
  EXPECT_EQ(encoder.Answer(0x602, {0x23, 0x03, 0x60, 0, 0, 0, 0, 0}),
            Frames{"582#8003600002000106"});  // read only
  EXPECT_EQ(encoder.Answer(0x603, {0x40, 0x01, 0x60, 0, 0, 0, 0, 0}), Frames{});
}

TEST(EncoderNode, AShaftThatCannotBeToldIsAnEmergencyUntilItCan) {
  Node encoder;
  encoder.Start();
  encoder.node.Sync(0.25 * kTurn);
  encoder.Said();
  encoder.node.Sync({});
  EXPECT_EQ(encoder.Said(), (Frames{"082#0050010000000000", "182#00400000"}));
  encoder.node.Sync({});
  EXPECT_EQ(encoder.Said(), Frames{"182#00400000"});  // said once
  EXPECT_EQ(encoder.Answer(0x602, {0x40, 0x01, 0x10, 0, 0, 0, 0, 0}),
            Frames{"582#4F01100001000000"});
  encoder.node.Sync(0.5 * kTurn);
  EXPECT_EQ(encoder.Said(), (Frames{"082#0000000000000000", "182#00800000"}));
}

TEST(EncoderNode, CountsOnThroughTheEndOfItsRange) {
  hal::EncoderSettings settings = Encoder();
  settings.range = 4 * 65536;  // four turns
  settings.zero = 1000;
  settings.sense = -1;
  Node encoder(settings);
  encoder.Start();
  // The angle comes modulo a turn; the count does not jump where it begins anew.
  std::int64_t before = 1000;
  for (int i = 1; i <= 600; ++i) {
    encoder.node.Sync(std::remainder(0.1 * i, kTurn));
    const auto count = hal::TakeBits(encoder.sent.back(), 0, 32, false);
    ASSERT_TRUE(count);
    const auto step = static_cast<double>((*count - before + 4 * 65536) % (4 * 65536) - 4 * 65536);
    EXPECT_NEAR(step, -0.1 / kTurn * 65536, 1.0);
    before = *count;
  }
}

// Whatever bits the PDO has the count in, the client's reader finds it there.
TEST(EncoderNode, PutsTheCountWhereTheSettingsSay) {
  for (const int bits : {8, 12, 16, 25, 32, 48}) {
    for (const int at : {0, 3, 16}) {
      for (const bool is_signed : {false, true}) {
        hal::EncoderSettings settings = Encoder();
        settings.tpdo = 3;
        settings.at_bit = at;
        settings.bits = bits;
        settings.is_signed = is_signed;
        settings.range = std::int64_t{1} << bits;
        settings.counts_per_turn = static_cast<double>(settings.range);
        Node encoder(settings);
        encoder.Start();
        for (const double share : {0.0, 0.2, 0.5, 0.75}) {
          encoder.node.Sync(share * kTurn);
          const hal::CanFrame& frame = encoder.sent.back();
          EXPECT_EQ(frame.id, 0x382u);
          EXPECT_EQ(frame.size, (at + bits + 7) / 8);
          const auto count = hal::TakeBits(frame, at, bits, is_signed);
          ASSERT_TRUE(count);
          EXPECT_EQ(*count < 0, is_signed && share >= 0.5) << bits << " bits at " << at;
          const double off = static_cast<double>(*count) / settings.counts_per_turn - share;
          EXPECT_LE(std::abs(std::remainder(off, 1.0)), 0.5 / settings.counts_per_turn);
        }
      }
    }
  }
}

}  // namespace encoder_node_test
}  // namespace abbe::rig
