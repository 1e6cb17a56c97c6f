#include "recording/target_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace abbe::recording {
namespace target_table_test {

class TargetTable : public testing::Test {
 protected:
  TargetTable() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("target_table_") + test->name() + ".dat");
  }
  ~TargetTable() override { std::filesystem::remove(path_); }

  Recording ReadText(const std::string& text, const std::string& axis = "X") const {
    std::ofstream(path_) << text;
    return ReadTargetTable(path_, axis);
  }

  // The message with which the text is refused, without the folder.
  std::string Refusal(const std::string& text, const std::string& axis = "X") const {
    try {
      ReadText(text, axis);
    } catch (const InputError& error) {
      const std::string message = error.what(), folder = path_.parent_path().string() + "/";
      return message.starts_with(folder)
                 ? message.substr(folder.size() + path_.stem().string().size())
                 : message;
    }
    return "accepted";
  }

  static std::vector<double> Values(const Recording& recording, std::size_t column) {
    return recording.columns[column].values;
  }

  std::filesystem::path path_;
};

using Numbers = std::vector<double>;

// All the habits of the test scripts at once: prefix, comments, sources, numbers without the
// leading zero, a last line of blanks, carriage returns.
const std::string kTable =
    "TEST_DATA=# Input data file\n# UNIT : a "
    "comment\n#\nREF_PV=IOC:\"ref\"\nTEST_PV=IOC:TestNumber\n"
    "TGT_SET_PV=AXIS:X-PosCmd\r\nUNIT=mm\nCYCLES=2\nPOSITIONS=2\nDEC=5\n"
    "TGT_DATA[1]=-20\nREF_DATA_FWD[1,1]=-20.05\nTGT_DATA[2]=0\nREF_DATA_FWD[2,1]=.0017\n"
    "REF_DATA_BWD[1,1]=-20.02\nREF_DATA_BWD[2,1]=-.003\nREF_DATA_FWD[1,2]=-20.06\n"
    "REF_DATA_FWD[2,2]=+.0018\nREF_DATA_BWD[2,2]=-4e-3\nREF_DATA_BWD[1,2]=-20.03\n  \n";

TEST_F(TargetTable, BecomesAReferenceRecordingInTheOrderOfMeasurement) {
  const Recording recording = ReadText(kTable);
  ASSERT_EQ(recording.columns.size(), 6u);
  const char* names[] = {"time_s", "x_mm", "pass", "direction", "ref_x_mm", "flags"};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(recording.columns[i].name, names[i]);
  EXPECT_EQ(Values(recording, 0), (Numbers{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(Values(recording, 1), (Numbers{-20, 0, 0, -20, -20, 0, 0, -20}));
  EXPECT_EQ(Values(recording, 2), (Numbers{1, 1, 1, 1, 2, 2, 2, 2}));
  EXPECT_EQ(Values(recording, 3), (Numbers{1, 1, -1, -1, 1, 1, -1, -1}));
  EXPECT_EQ(Values(recording, 4),
            (Numbers{-20.05, 0.0017, -0.003, -20.02, -20.06, 0.0018, -0.004, -20.03}));
  EXPECT_EQ(Values(recording, 5), Numbers(8, 0.0));
  EXPECT_TRUE(recording.warnings.empty());
}

TEST_F(TargetTable, TheHeaderSaysWhatItIsAndThatItKnowsNoTime) {
  const Recording recording = ReadText(kTable, "Y");
  EXPECT_EQ(recording.columns[1].name, "y_mm");
  EXPECT_EQ(recording.columns[4].name, "ref_y_mm");
  const std::string expected =
      "kind = \"reference\"\naxis = \"Y\"\ntime = \"order\"\nimported_from = "
      "\"" +
      path_.filename().string() +
      "\"\n[sources]\ny_mm = \"AXIS:X-PosCmd\"\nref_y_mm = \"IOC:\\\"ref\\\"\"\n";
  EXPECT_EQ(recording.header, expected);
}

TEST_F(TargetTable, ForwardsIsMinusWhereTheTargetsDescend) {
  const Recording recording = ReadText(
      "TGT_DATA[1]=5\nTGT_DATA[2]=1\nREF_DATA_FWD[1,1]=5\nREF_DATA_FWD[2,1]=1\n"
      "REF_DATA_BWD[1,1]=5\nREF_DATA_BWD[2,1]=1\n");
  EXPECT_EQ(Values(recording, 1), (Numbers{5, 1, 1, 5}));
  EXPECT_EQ(Values(recording, 3), (Numbers{-1, -1, 1, 1}));
}

TEST_F(TargetTable, UnitsAreConvertedToMillimetres) {
  const std::string rest = "TGT_DATA[1]=2\nREF_DATA_FWD[1,1]=3\nREF_DATA_BWD[1,1]=4\n";
  EXPECT_EQ(Values(ReadText(rest), 1), (Numbers{2, 2}));
  EXPECT_EQ(Values(ReadText("UNIT=m\n" + rest), 4), (Numbers{3000, 4000}));
  EXPECT_TRUE(ReadText("UNIT=m\n" + rest).warnings.empty());
  const std::vector<std::string> warnings = ReadText(rest).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("has no UNIT: its numbers are taken as mm"), std::string::npos);
  EXPECT_DOUBLE_EQ(Values(ReadText("UNIT=um\n" + rest), 4)[0], 0.003);
}

TEST_F(TargetTable, AMissingReadingIsAMissingRowAndAWarning) {
  const std::string line = "REF_DATA_BWD[2,1]=-.003\n";
  std::string text = kTable;
  text.erase(text.find(line), line.size());
  const Recording recording = ReadText(text);
  EXPECT_EQ(Values(recording, 0), (Numbers{0, 1, 3, 4, 5, 6, 7}));
  ASSERT_EQ(recording.warnings.size(), 1u);
  EXPECT_NE(
      recording.warnings[0].find("1 of 8 readings are missing, the first is REF_DATA_BWD[2,1]"),
      std::string::npos)
      << recording.warnings[0];
}

TEST_F(TargetTable, AnUnknownNameIsAWarning) {
  const Recording recording = ReadText(kTable + "TEMPERATURE=21.5\n");
  ASSERT_EQ(recording.warnings.size(), 1u);
  EXPECT_NE(recording.warnings[0].find("TEMPERATURE is not used"), std::string::npos);
}

TEST_F(TargetTable, RefusesABadLineByItsNumber) {
  EXPECT_EQ(Refusal("UNIT=mm\nhello\n"),
            ".dat:2: \"hello\" is not NAME=value; write comments after #");
  EXPECT_EQ(Refusal("TGT_DATA[1]=1O\n"),
            ".dat:1: TGT_DATA holds \"1O\" where a number is expected");
  EXPECT_EQ(Refusal("TGT_DATA[1]=nan\n"),
            ".dat:1: TGT_DATA holds \"nan\" where a number is expected");
  EXPECT_EQ(Refusal("TGT_DATA[1]=\n"), ".dat:1: TGT_DATA holds \"\" where a number is expected");
  EXPECT_EQ(Refusal("TGT_DATA[1=2\n"), ".dat:1: TGT_DATA has no closing ]");
  EXPECT_EQ(Refusal("TGT_DATA[0]=2\n"), ".dat:1: TGT_DATA holds 0: count from 1");
  EXPECT_EQ(Refusal("TGT_DATA=2\n"), ".dat:1: TGT_DATA needs one index, the position");
  EXPECT_EQ(Refusal("REF_DATA_FWD[1]=2\n"),
            ".dat:1: REF_DATA_FWD needs two indices, position and cycle");
  EXPECT_EQ(Refusal("\nUNIT=inch\n"), ".dat:2: UNIT is \"inch\": give m, mm or um");
  EXPECT_NE(Refusal("UNIT=deg\n").find("rotary axis are no lengths"), std::string::npos);
  EXPECT_EQ(Refusal("TGT_DATA[1]=1\nTGT_DATA[1]=1\n"),
            ".dat:2: TGT_DATA is given twice with these indices: keep one");
}

TEST_F(TargetTable, RefusesWhatDoesNotFitTogether) {
  EXPECT_NE(Refusal("").find("not a target and cycle table"), std::string::npos);
  EXPECT_NE(Refusal(kTable + "REF_DATA_FWD[3,1]=5\n").find("position 3, but there are 2"),
            std::string::npos);
  EXPECT_NE(Refusal(kTable + "REF_DATA_FWD[1,3]=5\n").find("cycle 3, but CYCLES=2"),
            std::string::npos);
  EXPECT_NE(Refusal(kTable + "TGT_DATA[4]=5\n").find("TGT_DATA[3] is missing"), std::string::npos);
  EXPECT_NE(Refusal(kTable + "TGT_DATA[3]=5\n").find("TGT_DATA[3] is given"), std::string::npos);
  EXPECT_NE(Refusal("TGT_DATA[1]=0\nTGT_DATA[2]=5\nTGT_DATA[3]=4\nREF_DATA_FWD[1,1]=0\n")
                .find("TGT_DATA[3]=4 after 5"),
            std::string::npos);
  EXPECT_NE(
      Refusal("CYCLES=1000000000\nTGT_DATA[1]=0\nREF_DATA_FWD[1,1]=0\n").find("at most 10000"),
      std::string::npos);
  EXPECT_NE(Refusal(kTable, "XY").find("choose X, Y or Z"), std::string::npos);
  EXPECT_THROW(ReadTargetTable("nowhere/nothing.dat"), InputError);
  EXPECT_THROW(ReadTargetTable(testing::TempDir()), InputError);
}

}  // namespace target_table_test
}  // namespace abbe::recording
