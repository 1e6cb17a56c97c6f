#include "settings/table_cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace abbe::settings {
namespace table_cells_test {

using testing::ElementsAre;

TEST(TableCells, MayBeginWithAByteOrderMark) {
  EXPECT_EQ(WithoutByteOrderMark("\xEF\xBB\xBFx,y"), "x,y");
  EXPECT_EQ(WithoutByteOrderMark("x,y"), "x,y");
}

TEST(TableCells, KnowTheirSeparator) {
  EXPECT_EQ(SeparatorOf("x,y"), ',');
  EXPECT_EQ(SeparatorOf("x;y"), ';');
  EXPECT_EQ(SeparatorOf("x\ty"), '\t');
  EXPECT_EQ(SeparatorOf("x\ty;z"), ';');
  EXPECT_EQ(SeparatorOf(""), ',');
}

TEST(TableCells, KeepASeparatorInsideQuotes) {
  EXPECT_THAT(CellsOf("1 , \"a, b\",", ','), ElementsAre("1", "\"a, b\"", ""));
  EXPECT_THAT(CellsOf("", ','), ElementsAre(""));
  EXPECT_THAT(CellsOf("\"open, never closed", ','), ElementsAre("\"open, never closed"));
}

TEST(TableCells, LoseTheirQuotes) {
  EXPECT_EQ(Unquoted("\" a, b \""), "a, b");
  EXPECT_EQ(Unquoted("\"say \"\"so\"\"\""), "say \"so\"");
  EXPECT_EQ(Unquoted("plain"), "plain");
  EXPECT_EQ(Unquoted("\""), "");
}

TEST(TableCells, HaveADecimalCommaWhereNoneSeparates) {
  EXPECT_EQ(WithDecimalPoint("-1,25", ';'), "-1.25");
  EXPECT_EQ(WithDecimalPoint("-1,25", '\t'), "-1.25");
  EXPECT_EQ(WithDecimalPoint("1,5", ','), "1,5");
  EXPECT_EQ(WithDecimalPoint("1,234,5", ';'), "1,234,5");
  EXPECT_EQ(WithDecimalPoint("1.234,5", ';'), "1.234,5");
}

}  // namespace table_cells_test
}  // namespace abbe::settings
