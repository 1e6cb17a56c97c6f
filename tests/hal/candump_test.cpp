// Logs of candump: lines as can-utils writes them, and what they become.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "failure/failure.h"
#include "hal/can/can_replay.h"
#include "hal/can/candump_recording.h"

namespace abbe::hal {
namespace candump_test {

class CandumpTest : public testing::Test {
 protected:
  CandumpTest()
      : path_(std::filesystem::temp_directory_path() /
              ("candump_" + std::to_string(getpid()) + ".log")) {}
  ~CandumpTest() override { std::filesystem::remove(path_); }

  CandumpLog Read(const std::string& text) {
    std::ofstream(path_) << text;
    return ReadCandump(path_);
  }
  std::string Refusal(const std::string& text) {
    try {
      Read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  recording::Recording Record(const std::string& text) {
    return RecordingOf(Read(text), Encoders(), 1.0, "mill");
  }
  // Two encoders of 16 bits, 65536 counts a turn; the second counts backwards from 1000.
  static CanopenSettings Encoders() {
    CanopenSettings settings{.name = "linkage", .interface = "can0", .times = {}, .encoders = {}};
    for (int node = 1; node <= 2; ++node) {
      EncoderSettings encoder;
      encoder.name = "pivot_" + std::to_string(node) + "_rad";
      encoder.node = node;
      encoder.bits = 16;
      encoder.counts_per_turn = 65536.0;
      encoder.range = 65536;
      settings.encoders.push_back(encoder);
    }
    settings.encoders[1].sense = -1;
    settings.encoders[1].zero = 1000;
    return settings;
  }

  std::filesystem::path path_;
};

constexpr double kStep = 2.0 * std::numbers::pi / 65536.0;

TEST_F(CandumpTest, ReadsEveryFormOfAFrame) {
  const CandumpLog log = Read(
      "(1763716800.250103) can0 181#DEADBEEF01\n"
      "(1763716800.250249) can1 1ABCDEF0#\n"
      "(1763716800.250390) can0 182#R8 R\n"
      "(1763716800.250400) can0 20000040#0000000000000000\n"
      "(1763716800.250410) can0 123##1AABB\n"
      "(1763716801.250103) can0 080# T\n");
  EXPECT_EQ(log.started_us, 1763716800250103);
  ASSERT_EQ(log.frames.size(), 4u);
  EXPECT_EQ(log.passed_over, 2u);
  EXPECT_EQ(log.frames[0].frame,
            (CanFrame{.id = 0x181, .size = 5, .data = {0xDE, 0xAD, 0xBE, 0xEF, 0x01}}));
  EXPECT_EQ(log.frames[1].frame, (CanFrame{.id = 0x1ABCDEF0, .extended = true}));
  EXPECT_EQ(log.frames[1].interface, "can1");
  EXPECT_EQ(log.frames[2].frame, (CanFrame{.id = 0x182, .remote = true, .size = 8}));
  EXPECT_DOUBLE_EQ(log.frames[1].time_s, 146e-6);
  EXPECT_DOUBLE_EQ(log.frames[3].time_s, 1.0);
}

TEST_F(CandumpTest, WhatIsWrittenIsWhatWasRead) {
  const std::string text =
      "(1763716800.000003) can0 001#01\n"
      "(1763716800.250249) vcan12 00000001#0011223344556677\n"
      "(1763716802.999999) can0 7FF#R\n";
  WriteCandump(Read(text), path_);
  std::stringstream written;
  written << std::ifstream(path_).rdbuf();
  EXPECT_EQ(written.str(), text);
}

TEST_F(CandumpTest, AnotherFormIsRefusedWithItsLine) {
  const std::string good = "(1763716800.250103) can0 181#00\n";
  for (const char* bad :
       {"can0 181 [1] 00", "(1763716800.250103) can0 181", "(1763716800.250103) can0 181#0",
        "(1763716800.250103) can0 181#001122334455667788", "(1763716800.250103) can0 1810#00",
        "(1763716800.250103) can0 FFF#00", "(1763716800.25) can0 181#00",
        "(1763716800.250103) can0 181#0G", "(1763716800.250103) can0 181#R9"}) {
    EXPECT_NE(Refusal(good + bad + "\n").find(path_.string() + ":2: "), std::string::npos) << bad;
  }
  EXPECT_NE(Refusal("").find("has no CAN frames"), std::string::npos);
}

TEST_F(CandumpTest, ACutLineAndACalendarSetBackAreWarnedOf) {
  const CandumpLog log = Read(
      "(1763716800.500000) can0 080#\n"
      "(1763716800.400000) can0 181#00\n"
      "(1763716800.600000) can0 181#0");
  ASSERT_EQ(log.frames.size(), 2u);
  EXPECT_EQ(log.frames[1].time_s, 0.0);
  EXPECT_EQ(log.warnings.size(), 2u);
}

TEST_F(CandumpTest, EachSyncIsARowAndTheAnglesAreThoseOfTheCounts) {
  const recording::Recording recording = Record(
      "(1763716800.500000) can0 701#00\n"  // boots; nothing is lost, for nothing was known
      "(1763716801.000000) can0 080#\n"
      "(1763716801.000200) can0 181#FFFF\n"
      "(1763716801.000400) can0 182#E903\n"
      "(1763716801.010000) can0 080#\n"
      "(1763716801.010400) can0 182#EA03\n"
      "(1763716801.010500) can0 181#0000\n"
      "(1763716801.020000) can0 080#\n"
      "(1763716801.020400) can0 182#EA03\n"
      "(1763716801.050000) can1 181#FF0F\n");
  EXPECT_EQ(recording.Kind(), "dwell");
  EXPECT_EQ(recording.HeaderText("started"), "2025-11-21T09:20:00.5Z");
  const auto time = recording.At("time_s"), first = recording.At("pivot_1_rad"),
             second = recording.At("pivot_2_rad"), flags = recording.At("flags");
  ASSERT_EQ(time.size(), 3u);
  EXPECT_NEAR(time[0], 0.5, 1e-9);
  EXPECT_NEAR(time[1], 0.51, 1e-9);
  EXPECT_DOUBLE_EQ(first[0], -kStep);
  EXPECT_DOUBLE_EQ(first[1], 0.0);
  EXPECT_DOUBLE_EQ(second[0], -kStep);
  EXPECT_DOUBLE_EQ(second[1], -2.0 * kStep);
  EXPECT_EQ(flags[0] + flags[1], 0.0);
  EXPECT_TRUE(std::isnan(first[2]));
  EXPECT_DOUBLE_EQ(second[2], -2.0 * kStep);
  EXPECT_EQ(flags[2], recording::kDeviceError);
}

TEST_F(CandumpTest, ANodeThatRebootsInTheLogHasLostItsReference) {
  const recording::Recording recording = Record(
      "(1763716801.000000) can0 080#\n"
      "(1763716801.000200) can0 181#0100\n"
      "(1763716801.000300) can0 182#E803\n"
      "(1763716801.005000) can0 701#00\n"
      "(1763716801.010000) can0 080#\n"
      "(1763716801.010200) can0 181#0100\n"
      "(1763716801.010300) can0 182#E803\n");
  EXPECT_DOUBLE_EQ(recording.At("pivot_1_rad")[0], kStep);
  EXPECT_TRUE(std::isnan(recording.At("pivot_1_rad").back()));
  EXPECT_EQ(recording.At("pivot_2_rad").back(), 0.0);
}

TEST_F(CandumpTest, ALogOfAnotherInterfaceOrWithoutTheseNodesIsRefused) {
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      Record(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refusal("(1763716801.000000) vcan3 080#\n").find("no frames of can0, but of vcan3"),
            std::string::npos);
  EXPECT_NE(refusal("(1763716801.000000) can0 080#\n(1763716801.1) can0 183#0000\n")
                .find("is no line of candump"),
            std::string::npos);
  EXPECT_NE(refusal("(1763716801.000000) can0 080#\n(1763716801.000100) can0 183#0000\n")
                .find("no encoder of device \"linkage\" gives a good angle"),
            std::string::npos);
}

// A recording becomes a log, the log a recording: the same counts at the same times.
RC_GTEST_FIXTURE_PROP(CandumpTest, ARecordingComesBackFromItsLog, ()) {
  const auto steps = *rc::gen::nonEmpty<std::vector<int>>(
      rc::gen::container<std::vector<int>>(rc::gen::inRange(-50, 51)));
  recording::Recording recording;
  recording.header = "kind = \"dwell\"\nstarted = 2026-11-21T09:00:00.25Z\n";
  recording.columns = {{"time_s", {}}, {"pivot_1_rad", {}}, {"pivot_2_rad", {}}};
  int count = 32000;  // near the end of half a turn, so that it wraps
  for (std::size_t row = 0; row < steps.size(); ++row) {
    count += steps[row];
    recording.columns[0].values.push_back(0.01 * static_cast<double>(row));
    recording.columns[1].values.push_back(kStep * count);
    const int other = count / 2;
    recording.columns[2].values.push_back(-kStep * other);
  }
  WriteCandump(LogOf(recording, Encoders()), path_);
  const recording::Recording again = RecordingOf(ReadCandump(path_), Encoders(), 1.0, "mill");
  RC_ASSERT(again.rows() == recording.rows());
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    RC_ASSERT(std::abs(again.columns[0].values[row] - recording.columns[0].values[row]) < 1e-6);
    for (const std::size_t column : {1u, 2u}) {
      RC_ASSERT(std::abs(again.columns[column].values[row] -
                         recording.columns[column].values[row]) < 1e-9);
    }
  }
}

// The pace is the clock's, and a listener cannot send.
TEST_F(CandumpTest, TheReplayKeepsThePaceOfTheLog) {
  HandClock clock;
  clock.Advance(7.0);
  CanReplay bus(Read("(1763716801.000000) can0 080#\n(1763716801.500000) can0 181#00\n"), "can0",
                clock);
  EXPECT_FALSE(bus.Send({.id = 1}));
  EXPECT_DOUBLE_EQ(bus.Receive(8.0)->time_s, 7.0);
  EXPECT_FALSE(bus.Receive(7.25).has_value());
  EXPECT_DOUBLE_EQ(clock.Now(), 7.25);
  EXPECT_FALSE(bus.Ended());
  EXPECT_DOUBLE_EQ(bus.Receive(8.0)->time_s, 7.5);
  EXPECT_DOUBLE_EQ(clock.Now(), 7.5);
  EXPECT_TRUE(bus.Ended());
  EXPECT_FALSE(bus.Receive(100.0).has_value());
}

// A calendar that is set forward makes years of silence, which no rows stand for.
TEST_F(CandumpTest, TheSilenceOfALogThatWasSetForwardHasNoRows) {
  for (const char* stamp : {"1763803200.250303", "4294967295.250303"}) {
    const std::string later(stamp);
    const auto recording = Record(
        "(1763716800.250103) can0 080#\n(1763716800.250203) can0 181#0100\n"
        "(1763716800.250204) can0 182#0100\n"
        "(" +
        later + ") can0 080#\n(" + later + ") can0 181#0200\n(" + later + ") can0 182#0200\n");
    EXPECT_LE(recording.rows(), 5u);
    ASSERT_EQ(recording.warnings.size(), 1u);
    EXPECT_NE(recording.warnings[0].find("calendar was set"), std::string::npos);
    EXPECT_NEAR(recording.At("time_s").back(), std::stod(later) - 1763716800.250103, 1e-3);
    EXPECT_NEAR(recording.At("pivot_1_rad").back(), 2 * kStep, 1e-9);
  }
}

}  // namespace candump_test
}  // namespace abbe::hal
