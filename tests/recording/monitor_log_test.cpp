#include "recording/monitor_log.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace abbe::recording {
namespace monitor_log_test {

using ::testing::HasSubstr;

const char kLog[] =
    "W:angle  2023-02-08 23:59:59.500000 10.5  \n"
    "W:gap    2023-02-08 23:59:59.250000 1.5 HIGH MINOR\r\n"
    "W:mood   2023-02-08 23:59:59.000000 fine\n"
    "W:gap    *** Not connected\n"
    "\n"
    "W:gap    2023-02-09 00:00:00.500000 1.25\n"
    "W:angle  2023-02-09 00:00:00.500000 -3e1\n";

class MonitorLog : public testing::Test {
 protected:
  MonitorLog()
      : path_(std::filesystem::path(testing::TempDir()) /
              fmt::format("monitor_log_test_{}.log", getpid())) {}
  ~MonitorLog() override { std::filesystem::remove(path_); }

  Recording ReadText(const std::string& text) const {
    std::ofstream(path_) << text;
    return ReadMonitorLog(path_, {{"shaft_deg", "W:angle"}, {"gap_mm", "W:gap"}});
  }
  std::string Refusal(const std::string& text) const {
    try {
      ReadText(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  std::filesystem::path path_;
};

TEST_F(MonitorLog, GivesARowForEachMomentInOrderOfTime) {
  const Recording recording = ReadText(kLog);
  ASSERT_EQ(recording.rows(), 3U);
  const auto time = recording.At("time_s"), angle = recording.At("shaft_deg"),
             gap = recording.At("gap_mm");
  EXPECT_EQ(std::vector<double>(time.begin(), time.end()), (std::vector<double>{0.0, 0.25, 1.25}));
  EXPECT_TRUE(std::isnan(angle[0]) && std::isnan(gap[1]));
  EXPECT_EQ(gap[0], 1.5);
  EXPECT_EQ(angle[1], 10.5);
  EXPECT_EQ(gap[2], 1.25);
  EXPECT_EQ(angle[2], -30.0);
  EXPECT_EQ(recording.Kind(), "dwell");
  EXPECT_EQ(recording.HeaderText("sources.gap_mm"), "W:gap");
  EXPECT_THAT(recording.header, HasSubstr("started = 2023-02-08T23:59:59.250000"));
}

TEST_F(MonitorLog, IsToldFromALogOfCandump) {
  ReadText(kLog);
  EXPECT_TRUE(IsMonitorLog(path_));
  std::ofstream(path_) << "(1763716801.000000) vcan0 181#00000400\n";
  EXPECT_FALSE(IsMonitorLog(path_));
}

TEST_F(MonitorLog, IsOfAShaftWhereTheSensorsStand) {
  std::ofstream(path_) << "W:angle 2023-02-08 12:00:00.0 1\nW:gap 2023-02-08 12:00:00.1 2\n";
  const auto recording =
      ReadMonitorLog(path_, {{"shaft_deg", "W:angle"}, {"gap_1_mm", "W:gap"}}, {22.5});
  EXPECT_EQ(recording.Kind(), "shaft");
  EXPECT_EQ(recording.HeaderNumbers("sensor_deg", 1), std::vector<double>{22.5});
}

TEST_F(MonitorLog, NamesTheWrongLine) {
  EXPECT_THAT(Refusal("W:gap 2023-02-08 12:00:00.0 1\nW:gap 2023-02-30 12:00:00.0 2\n"),
              HasSubstr("log:2: no date and time after \"W:gap\""));
  EXPECT_THAT(Refusal("W:gap 2023-02-08 12:00:00.0 wide\n"),
              HasSubstr("log:1: \"wide\" of W:gap is not a number"));
  EXPECT_THAT(Refusal("W:gap 2023-02-08 12:00:00.0 1\nW:x 2023-02-08 12:00:00.0 1\n"),
              HasSubstr("channel \"W:angle\" has no value; the log has W:gap, W:x"));
  std::ofstream(path_) << kLog;
  EXPECT_THROW(ReadMonitorLog(path_, {}), InputError);
}

TEST_F(MonitorLog, AMomentIsOneOfTheCalendar) {
  for (const char* moment :
       {"9999-12-31 14:21:15.0", "2023-02-08 2147483647:21:15.0", "2023-02-08 14:21:nan",
        "2023-02-08 14:21:1e5", "2023-02-08 24:00:00", "2023-02-08 14:60:00", "2023-02-08 14:21:60",
        "2023-02-08 -1:21:15", "2023-02-30 14:21:15", "2023-02-08 14:21:15.", "0000-01-01 00:00:00",
        "2023-02-08 14:21:15x0"}) {
    const std::string text = "W:gap 2023-02-08 14:21:15 1\nW:gap " + std::string(moment) + " 1.5\n";
    EXPECT_THAT(Refusal(text), HasSubstr(":2: no date and time after \"W:gap\"")) << moment;
  }
}

TEST_F(MonitorLog, NamesWithQuotesStayAHeader) {
  std::ofstream(path_) << "a'\"b 2023-02-08 14:21:15.5 1\n";
  const Recording recording = ReadMonitorLog(path_, {{"my gap_mm", "a'\"b"}});
  EXPECT_EQ(recording.HeaderText("sources.my gap_mm"), "a'\"b");
}

}  // namespace monitor_log_test
}  // namespace abbe::recording
