#include "hal/can/canopen_settings.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "../folders.h"
#include "hal/can/canopen_device.h"
#include "hal/device_settings.h"

namespace abbe::hal {
namespace canopen_settings_test {

std::vector<CanopenSettings> Read(const settings::Document& file) {
  return SettingsOf<CanopenDevice>(ReadDevices(file.Root().Child("devices")));
}
std::vector<CanopenSettings> Read(const std::string& text) {
  return Read(settings::Document::Parse(text, "m.toml"));
}

std::string Refusal(const std::string& node) {
  try {
    Read("[devices.link]\ntransport = 'canopen'\ninterface = 'can0'\n" + node);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CanopenSettings, ReadsTheDemonstrationMachine) {
  const auto file = settings::Document::Read(DemoMillFile());
  const auto all = Read(file);
  ASSERT_EQ(all.size(), 1u);
  const CanopenSettings& linkage = all[0];
  EXPECT_EQ(linkage.name, "linkage");
  EXPECT_EQ(linkage.interface, "vcan0");
  EXPECT_DOUBLE_EQ(linkage.times.sync, 1e-3);
  ASSERT_EQ(linkage.encoders.size(), 3u);
  EXPECT_EQ(linkage.encoders[2].name, "pivot_3_rad");
  EXPECT_EQ(linkage.encoders[2].node, 3);
  EXPECT_EQ(linkage.encoders[2].range, 1 << 24);
}

TEST(CanopenSettings, EveryKeyIsRead) {
  const EncoderSettings encoder =
      Read(
          "[devices.link]\ntransport = 'canopen'\ninterface = 'can0'\nsync_ms = 0\n"
          "answer_timeout_ms = 5\nheartbeat_timeout_ms = 0\n[[devices.link.node]]\nid = 9\nname = "
          "'pivot_1_rad'\ntpdo = 2\nat_bit = 16\nbits = 25\nsigned = true\ncounts_per_turn = 4096\n"
          "range = 33554432\nsense = -1\nzero = -12\nfastest_rad_s = 3\nmay_freeze = false\n"
          "serial = 4294967295\n")
          .at(0)
          .encoders.at(0);
  EXPECT_EQ(encoder.node, 9);
  EXPECT_EQ(encoder.tpdo, 2);
  EXPECT_EQ(encoder.at_bit, 16);
  EXPECT_EQ(encoder.bits, 25);
  EXPECT_TRUE(encoder.is_signed);
  EXPECT_EQ(encoder.counts_per_turn, 4096.0);
  EXPECT_EQ(encoder.range, 33554432);
  EXPECT_EQ(encoder.sense, -1);
  EXPECT_EQ(encoder.zero, -12);
  EXPECT_EQ(encoder.fastest, 3.0);
  EXPECT_FALSE(encoder.may_freeze);
  EXPECT_EQ(encoder.serial, 4294967295u);
}

TEST(CanopenSettings, RefusesWithLineKeyAndRemedy) {
  const std::string node = "[[devices.link.node]]\nname = 'pivot_1_rad'\nid = 1\n";
  EXPECT_EQ(Refusal(""), "m.toml:1: devices.link.node: is missing; there is at least one encoder");
  EXPECT_EQ(Refusal(node),
            "m.toml:4: devices.link.node[0].counts_per_turn: is missing; it must be a number");
  EXPECT_EQ(Refusal(node + "counts_per_turn = 8192\nrange = 4096\n"),
            "m.toml:8: devices.link.node[0].range: 4096 is less than one turn of 8192 counts");
  EXPECT_EQ(Refusal(node + "counts_per_turn = 16\nat_bit = 40\nbits = 32\n"),
            "m.toml:9: devices.link.node[0].bits: reaches beyond the 64 bits of a PDO");
  EXPECT_EQ(Refusal(node + "counts_per_turn = 16\nsense = 0\n"),
            "m.toml:8: devices.link.node[0].sense: must be 1 or -1");
  EXPECT_EQ(
      Refusal(node + "counts_per_turn = 16\n[[devices.link.node]]\nid = 1\nname = "
                     "'pivot_2_rad'\ncounts_per_turn = 16\n"),
      "m.toml:9: devices.link.node[1].id: 1 is used twice on this bus; each node has its own");
  EXPECT_EQ(Refusal(node + "counts_per_turn = 16\n[[devices.link.node]]\nid = 2\nname = "
                           "'pivot_1_rad'\ncounts_per_turn = 16\n"),
            "m.toml:4: devices.link.node: the channel name \"pivot_1_rad\" is used twice");
  EXPECT_EQ(Refusal(node + "counts_per_turm = 16\ncounts_per_turn = 16\n"),
            "m.toml:7: devices.link.node[0].counts_per_turm: is not a known key; did you mean "
            "\"counts_per_turn\"?");
  EXPECT_EQ(Refusal("[[devices.link.node]]\nid = 1\nname = 'pivot_1'\n"),
            "m.toml:6: devices.link.node[0].name: must end in _rad: an encoder gives an angle, as "
            "in \"pivot_1_rad\"");
}

// Counts that no integer holds, before they are wrapped.
TEST(CanopenSettings, AnAngleBeyondAllCountsStillHasOne) {
  EncoderSettings encoder;
  encoder.counts_per_turn = 65536.0;
  encoder.range = 65536;
  encoder.sense = -1;
  encoder.zero = -9007199254740992;
  for (const double angle : {1e300, -1e300, 1e15}) {
    const std::int64_t count = CountOf(encoder, angle);
    EXPECT_GE(count, 0);
    EXPECT_LT(count, encoder.range);
  }
}

RC_GTEST_PROP(CanopenSettings, TheCountOfAnAngleIsThatAngleModuloTheRange, ()) {
  EncoderSettings encoder;
  encoder.counts_per_turn = *rc::gen::inRange(16, 1 << 20);
  encoder.range = static_cast<std::int64_t>(encoder.counts_per_turn) * *rc::gen::inRange(1, 99);
  encoder.is_signed = *rc::gen::arbitrary<bool>();
  encoder.sense = *rc::gen::element(1, -1);
  encoder.zero = *rc::gen::inRange(-5000, 5000);
  const double angle = *rc::gen::inRange(-100000, 100000) * 1e-3;
  const std::int64_t count = CountOf(encoder, angle);
  const std::int64_t low = encoder.is_signed ? -(encoder.range / 2) : 0;
  RC_ASSERT(count >= low && count < low + encoder.range);
  const double turn = static_cast<double>(encoder.range) * encoder.Step();
  const double back = encoder.sense * static_cast<double>(count - encoder.zero) * encoder.Step();
  // Half a count, and rounding of a number of some 1e6 counts.
  RC_ASSERT(std::abs(std::remainder(back - angle, turn)) <= 0.5 * encoder.Step() + 1e-9);
}

}  // namespace canopen_settings_test
}  // namespace abbe::hal
