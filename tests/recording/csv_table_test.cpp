#include "recording/csv_table.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace abbe::recording {
namespace csv_table_test {

using testing::HasSubstr;

const char kTable[] =
    "pose,arm,lS,x_m,unc_m\n"
    "# by hand\n"
    "1,1,0.5,1.5,6e-06\n"
    "2,2.0,0.25, 1.25,5e-06\r\n"
    "\n"
    "3,2,-1,nan,7e-06\n";

const CsvTableOptions kOptions{
    {{"pivot_1_rad", "lS"}, {"ref_x_mm", "x_m"}, {"ref_u_um", "unc_m"}}, {{"arm", "2"}}, "linkage"};

class CsvTable : public testing::Test {
 protected:
  CsvTable()
      : path_(std::filesystem::path(testing::TempDir()) /
              fmt::format("csv_table_test_{}.csv", getpid())) {}
  ~CsvTable() override { std::filesystem::remove(path_); }

  Recording ReadText(const std::string& text, const CsvTableOptions& options = kOptions) const {
    std::ofstream(path_) << text;
    return ReadCsvTable(path_, options);
  }
  std::string Refusal(const std::string& text, const CsvTableOptions& options = kOptions) const {
    try {
      ReadText(text, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  std::filesystem::path path_;
};

TEST_F(CsvTable, ColumnsTakeTheirNamesAndUnits) {
  const Recording recording = ReadText(kTable);
  EXPECT_EQ(recording.Kind(), "linkage");
  EXPECT_FALSE(recording.KnowsTimes());
  ASSERT_EQ(recording.rows(), 2U);
  EXPECT_THAT(recording.At("time_s"), testing::ElementsAre(1.0, 2.0));  // the order in the table
  EXPECT_THAT(recording.At("pivot_1_rad"), testing::ElementsAre(0.25, -1.0));
  EXPECT_DOUBLE_EQ(recording.At("ref_x_mm")[0], 1250.0);
  EXPECT_DOUBLE_EQ(recording.At("ref_u_um")[1], 7.0);
  EXPECT_EQ(recording.HeaderText("sources.ref_x_mm"), "x_m");
}

TEST_F(CsvTable, ARowWithoutANumberIsFlagged) {
  EXPECT_THAT(ReadText(kTable).At("flags"), testing::ElementsAre(0.0, kDeviceError));
}

TEST_F(CsvTable, ATimeOfItsOwnIsKept) {
  const Recording recording =
      ReadText("t_s,q\n0.5,1\n", {{{"time_s", "t_s"}, {"pivot_1_rad", "q"}}, {}, "linkage"});
  EXPECT_TRUE(recording.KnowsTimes());
  EXPECT_THAT(recording.At("time_s"), testing::ElementsAre(0.5));
}

TEST_F(CsvTable, RefusalsSayWhatIsWrong) {
  EXPECT_THAT(Refusal("a,b\n1,2\n"), HasSubstr("has no column \"lS\"; it has a, b"));
  EXPECT_THAT(Refusal("lS,x_m,unc_m,arm\n1,2\n"), HasSubstr(":2: 2 cells, but the table has 4"));
  EXPECT_THAT(Refusal("lS,x_m,unc_m,arm\n1,2,3,1\n"), HasSubstr("no row is left"));
  EXPECT_THAT(Refusal(kTable, {{}, {}, "linkage"}), HasSubstr("name them with their units"));
}

}  // namespace csv_table_test
}  // namespace abbe::recording
