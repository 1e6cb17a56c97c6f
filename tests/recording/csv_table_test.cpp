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

// As spreadsheets and data loggers write units.
TEST_F(CsvTable, UnitsInBracketsAreConverted) {
  const Recording recording = ReadText(
      "Zeit [ms];Ist X [m];Soll Y (\u00b5m);Z / inch;J 1 [deg];Druck [hPa]\n1500;0,25;300;2;180;7\n",
      {{{"time_s", "Zeit [ms]"},
        {"x_mm", "Ist X [m]"},
        {"y_mm", "Soll Y (\u00b5m)"},
        {"z_mm", "Z / inch"},
        {"pivot_1_rad", "\"J 1 [deg]\"*2"},
        {"own", "Druck [hPa]"}},
       {},
       "linkage"});
  EXPECT_DOUBLE_EQ(recording.At("time_s")[0], 1.5);
  EXPECT_DOUBLE_EQ(recording.At("x_mm")[0], 250.0);
  EXPECT_DOUBLE_EQ(recording.At("y_mm")[0], 0.3);
  EXPECT_DOUBLE_EQ(recording.At("z_mm")[0], 50.8);
  EXPECT_DOUBLE_EQ(recording.At("pivot_1_rad")[0], 2 * 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(recording.At("own")[0], 7.0);
  EXPECT_TRUE(recording.warnings.empty());
}

TEST_F(CsvTable, AUnitOfAnotherQuantityIsRefused) {
  EXPECT_THAT(Refusal("angle_deg\n1\n", {{{"ref_x_mm", "angle_deg"}}, {}, "linkage"}),
              HasSubstr("\"angle_deg\" is in deg, which is no unit of what is wanted in mm"));
}

// probe_c is no temperature.
TEST_F(CsvTable, ALetterAtTheEndThatIsNoUnitOfThisIsTakenAsItIs) {
  const Recording recording =
      ReadText("probe_c\n98.5\n", {{{"probe_c_um", "probe_c"}}, {}, "sweep"});
  EXPECT_DOUBLE_EQ(recording.At("probe_c_um")[0], 98.5);
  ASSERT_EQ(recording.warnings.size(), 1U);
  EXPECT_THAT(recording.warnings[0], HasSubstr("\"probe_c\" is taken as it is, in um"));
}

TEST_F(CsvTable, ARowWithoutANumberIsFlagged) {
  EXPECT_THAT(ReadText(kTable).At("flags"), testing::ElementsAre(0.0, kDeviceError));
}

// The same poses are the same recording, whatever the order of their lines, where a column tells it.
TEST_F(CsvTable, RowsAreSortedByTheirTimeOrIndex) {
  for (const char* name : {"time_s", "order"}) {
    const CsvTableOptions options{{{"pivot_1_rad", "q"}, {name, "n"}}, {}, "linkage"};
    const Recording recording = ReadText("n,q\n7,0.3\n2,0.1\n7,0.4\n5,0.2\n", options);
    EXPECT_THAT(recording.At("time_s"), testing::ElementsAre(2.0, 5.0, 7.0, 7.0));
    EXPECT_THAT(recording.At("pivot_1_rad"), testing::ElementsAre(0.1, 0.2, 0.3, 0.4));
    EXPECT_EQ(recording.KnowsTimes(), std::string_view(name) == "time_s");
    EXPECT_FALSE(recording.Find("order"));
  }
}

TEST_F(CsvTable, ShuffledRowsHaveNoTime) {
  CsvTableOptions options{{{"pivot_1_rad", "q"}}, {}, "linkage"};
  options.shuffled = true;
  const Recording recording = ReadText("n,q\n7,0.3\n2,0.1\n", options);
  EXPECT_FALSE(recording.Find("time_s"));
  EXPECT_FALSE(recording.KnowsTimes());
  EXPECT_FALSE(recording.HeaderText("time"));
  options.columns.push_back({"order", "n"});
  EXPECT_THAT(Refusal("n,q\n7,0.3\n", options), testing::HasSubstr("leave one"));
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
  EXPECT_THAT(Refusal(kTable, {{}, {}, "linkage"}), HasSubstr("name the columns with their units"));
}

TEST_F(CsvTable, IsReadAsSpreadsheetsWriteIt) {
  const std::string text =
      "\xEF\xBB\xBF\"time_s\";\"gap 1\";note\r\n0,5;-1,25;\"a;b\"\r\n1;+2;\"say \"\"so\"\"\"\r\n";
  const CsvTableOptions options{{{"time_s", "time_s"}, {"gap_1_mm", "gap 1"}}, {}, "dwell"};
  for (const char separator : {';', '\t'}) {
    std::string other = text;
    if (separator == '\t') {
      std::replace(other.begin(), other.end(), ';', separator);
    }
    const Recording recording = ReadText(other, options);
    EXPECT_THAT(recording.At("time_s"), testing::ElementsAre(0.5, 1.0));
    EXPECT_THAT(recording.At("gap_1_mm"), testing::ElementsAre(-1.25, 2.0));
    EXPECT_THAT(recording.At("flags"), testing::ElementsAre(0.0, 0.0));
  }
  // Where commas part the cells, "1,234" in quotes may be a thousand: it is no number.
  EXPECT_THAT(Refusal("a,b\n\"1,234\",2\n", {{{"gap_1_mm", "a"}}, {}, "dwell"}),
              HasSubstr("no row has a number"));
  EXPECT_THAT(Refusal("a,b\n1,5,2,5\n", {{{"gap_1_mm", "a"}}, {}, "dwell"}),
              HasSubstr("decimal commas"));
}

TEST_F(CsvTable, NamesMayBeGivenForATableWithout) {
  CsvTableOptions options{{{"gap_1_mm", "b"}}, {}, "dwell", {"a", "b"}};
  EXPECT_THAT(ReadText("1,2\n3,4\n", options).At("gap_1_mm"), testing::ElementsAre(2.0, 4.0));
  options = {{}, {}, "dwell", {"time_s", "-", "gap_1_mm"}};
  const Recording recording = ReadText("0,7,2\n1,8,4\n", options);
  EXPECT_EQ(recording.columns.size(), 3u);  // with flags
  EXPECT_THAT(recording.At("gap_1_mm"), testing::ElementsAre(2.0, 4.0));
  EXPECT_THAT(Refusal("1,2\n", options), HasSubstr(":1: 2 cells, but the table has 3"));
}

TEST_F(CsvTable, AColumnMayBeASumOfOthers) {
  const auto first = [&](const std::string& sum, const std::string& name = "shaft_deg") {
    return ReadText("counts,a,b_um,gap-1,x y\n1000,2,3,5,7\n", {{{name, sum}}, {}, "dwell"})
        .At(name)[0];
  };
  EXPECT_DOUBLE_EQ(first("counts*0.00549+3"), 8.49);
  EXPECT_DOUBLE_EQ(first("3 + 0.00549 * counts"), 8.49);
  EXPECT_DOUBLE_EQ(first("-a/4 - 1e-1"), -0.6);
  EXPECT_DOUBLE_EQ(first("counts - a + 2*a*3"), 1010.0);
  EXPECT_DOUBLE_EQ(first("b_um + a", "z_mm"), 2.003);  // the column of um, in mm
  EXPECT_DOUBLE_EQ(first("gap-1"), 5.0);               // a name, not a difference
  EXPECT_DOUBLE_EQ(first("gap-1 - 1"), 4.0);
  EXPECT_DOUBLE_EQ(first("\"x y\"*2"), 14.0);
  EXPECT_DOUBLE_EQ(first("x y"), 7.0);
  const auto refusal = [&](const std::string& sum) {
    return Refusal("counts,a\n1,2\n", {{{"shaft_deg", sum}}, {}, "dwell"});
  };
  EXPECT_THAT(refusal("count*2"), HasSubstr("has no column \"count\"; it has counts, a"));
  EXPECT_THAT(refusal("a*counts"), HasSubstr("multiplies or divides by a column"));
  EXPECT_THAT(refusal("2/a"), HasSubstr("multiplies or divides by a column"));
  EXPECT_THAT(refusal("a/0"), HasSubstr("divides by 0"));
  EXPECT_THAT(refusal("3"), HasSubstr("names no column"));
  EXPECT_THAT(refusal("a+"), HasSubstr("is missing"));
  EXPECT_THAT(refusal("a 2"), HasSubstr("is not a sum"));
  EXPECT_THAT(refusal("1e999*a"), HasSubstr("has no column"));
}

}  // namespace csv_table_test
}  // namespace abbe::recording
