#include "recording/laser_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace abbe::recording {
namespace laser_table_test {

// As four public programs of others write or read it: blanks before and behind the colon, several
// targets a line, environment that is not used, ends of lines of Windows.
const std::string kTable =
    "HEADER::\r\nFile type  : rtl\r\nOwner      : Linear\r\nVersion no : V20.02.02\r\n\r\n"
    "TARGET DATA::\r\nFiletype  : ISO\r\nTarget-count: 3\r\nTargets :\r\n-100.000  0.000 \r\n"
    "100.000 \r\nFlags: 0 0 2 0\r\n\r\n"
    "USER-TEXT::\r\nMachine:  mill\r\nSerial No:\r\nDate:2024-05-06 10:11:12\r\nBy:\r\nAxis:Y\r\n"
    "Location:\r\nTITLE:Y: slow\r\n\r\nRUNS::\r\nRun-count:4\r\n\r\nDEVIATIONS::\r\n"
    "Run Target Data:\r\n1   1      0.5\r\n1   2      -1.25\r\n1   3      2\r\n"
    "2   3      3\r\n2   2      -0.25\r\n2   1      +1.5\r\n"
    "3   1      0.6\r\n3   2      -1.2\r\n3   3      2.1\r\n"
    "4   3      3.1\r\n4   2      -0.2\r\n4   1      1.4\r\n\r\n"
    "ENVIRONMENT::\r\nAir temp   : 20.1\r\n\r\nEOF::\r\n";

std::string With(const std::string& from, const std::string& to) {
  std::string text = kTable;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class LaserTable : public testing::Test {
 protected:
  LaserTable() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("laser_table_") + test->name() + ".rtl");
  }
  ~LaserTable() override { std::filesystem::remove(path_); }

  Recording ReadText(const std::string& text, const std::string& axis = "") const {
    std::ofstream(path_, std::ios::binary) << text;
    return ReadLaserTable(path_, axis);
  }

  // The message with which the text is refused, behind the name of the file.
  std::string Refusal(const std::string& text) const {
    try {
      ReadText(text);
    } catch (const InputError& error) {
      const std::string message = error.what();
      return message.substr(message.find(".rtl") + 4);
    }
    return "accepted";
  }

  std::filesystem::path path_;
};

using Numbers = std::vector<double>;

TEST_F(LaserTable, BecomesAReferenceRecordingInTheOrderOfMeasurement) {
  const Recording recording = ReadText(kTable);
  EXPECT_NE(recording.header.find("kind = \"reference\"\naxis = \"Y\""), std::string::npos);
  ASSERT_EQ(recording.columns.size(), 6u);
  EXPECT_EQ(recording.columns[1].name, "y_mm");
  EXPECT_EQ(recording.columns[1].values,
            (Numbers{-100, 0, 100, 100, 0, -100, -100, 0, 100, 100, 0, -100}));
  EXPECT_EQ(recording.columns[2].values, (Numbers{1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2}));
  EXPECT_EQ(recording.columns[3].values, (Numbers{1, 1, 1, -1, -1, -1, 1, 1, 1, -1, -1, -1}));
  EXPECT_EQ(recording.columns[4].name, "ref_y_mm");
  const Numbers deviations_um{0.5, -1.25, 2, 3, -0.25, 1.5, 0.6, -1.2, 2.1, 3.1, -0.2, 1.4};
  for (std::size_t i = 0; i < deviations_um.size(); ++i) {
    const double target = recording.columns[1].values[i];
    EXPECT_NEAR(recording.columns[4].values[i] - target, 1e-3 * deviations_um[i], 1e-12);
  }
  EXPECT_TRUE(recording.warnings.empty());
}

TEST_F(LaserTable, TheAxisIsTheFilesUnlessItIsGiven) {
  EXPECT_EQ(ReadText(kTable, "Z").columns[1].name, "z_mm");
  EXPECT_EQ(ReadText(kTable, "Z").warnings.size(), 1u);
  EXPECT_EQ(Refusal(With("Axis:Y", "Axis:")), ": does not state its axis; give it with --axis X");
  EXPECT_EQ(Refusal(With("Axis:Y", "Axis:B")), ": axis \"B\": choose X, Y or Z");
}

TEST_F(LaserTable, MissingReadingsAreLeftOutWithAWarning) {
  const Recording recording = ReadText(With("2   2      -0.25\r\n", ""));
  EXPECT_EQ(recording.columns[0].values.size(), 11u);
  ASSERT_EQ(recording.warnings.size(), 1u);
  EXPECT_NE(recording.warnings[0].find("1 of 12 readings are missing, the first is backwards[2,1]"),
            std::string::npos);
}

TEST_F(LaserTable, WhatHasAnotherFormIsRefusedWithItsLine) {
  EXPECT_EQ(Refusal(With("-100.000", "-100,000")),
            ":10: \"-100,000\" is not a number (with a decimal point)");
  EXPECT_EQ(Refusal(With(": rtl", ": rta")),
            ":2: a file of type \"rta\"; read are linear positioning tests (rtl); write others as "
            "CSV");
  EXPECT_NE(Refusal(With("Flags: 0 0", "Flags: 0 1")).find(":12: a test in one direction"),
            std::string::npos);
  EXPECT_NE(Refusal(With("Flags: 0 0", "Flags: 0 7")).find(":12: flags \"0 7 2 0\""),
            std::string::npos);
  EXPECT_EQ(Refusal(With("2   3      3\r", "1   3      3\r")),
            ":31: run 1, target 3 is given twice: keep one");
  EXPECT_EQ(Refusal(With("1   3      2\r", "1   4      2\r")),
            ":30: \"4\" is no number from 1 to 3");
  EXPECT_EQ(Refusal(With("1   3      2\r", "1   3\r")),
            ":30: \"1   3\" is not run, target, deviation");
  EXPECT_EQ(Refusal(With("Target-count: 3", "Target-count: 4")),
            ": 3 targets, but Target-count is 4; correct one of them");
  EXPECT_EQ(Refusal(With("Run-count:4", "Run-count:9999")),
            ": 12 readings of 9999 runs of 3 targets; correct Run-count");
  EXPECT_NE(Refusal(With("100.000 \r", "-100.000 \r")).find("targets must ascend"),
            std::string::npos);
  EXPECT_EQ(Refusal(With("EOF::\r\n", "")), ": ends without EOF::, it is truncated; copy it again");
  EXPECT_EQ(Refusal("x,y\n1,2\n"), ": no section such as TARGET DATA::, not a table of a laser");
}

// Without flags the order of the lines has to show which runs go back.
TEST_F(LaserTable, ARunWhoseDirectionIsNotSureIsRefused) {
  std::string text = With("Flags: 0 0 2 0\r\n", "");
  EXPECT_EQ(ReadText(text).columns[3].values[3], -1.0);
  const auto at = text.find("2   3      3\r\n2   2      -0.25");
  text.replace(at, 29, "2   2      -0.25\r\n2   3      3");
  EXPECT_NE(Refusal(text).find(":31: run 2 goes along the targets, and no Flags"),
            std::string::npos);
  std::string odd = kTable;
  const auto first = odd.find("1   1      0.5\r\n1   2      -1.25");
  odd.replace(first, 31, "1   2      -1.25\r\n1   1      0.5");
  EXPECT_NE(Refusal(odd).find(":29: run 1 goes back along the targets"), std::string::npos);
}

}  // namespace laser_table_test
}  // namespace abbe::recording
