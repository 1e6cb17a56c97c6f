#include "settings/column_name.h"

#include <gtest/gtest.h>

namespace abbe::settings {
namespace column_name_test {

TEST(ColumnName, IsAQuantityAndItsUnit) {
  for (const auto* name : {"X [mm]", "X(mm)", "X / mm", "X_mm", "X [ mm ]"}) {
    EXPECT_EQ(ColumnNameOf(name).quantity, "X") << name;
    EXPECT_EQ(ColumnNameOf(name).unit.name, "mm") << name;
  }
  EXPECT_EQ(ColumnNameOf("speed [m/min]").unit.name, "m/min");
  EXPECT_EQ(ColumnNameOf("order (of probing)").quantity, "order (of probing)");
  EXPECT_EQ(ColumnNameOf("order (of probing)").unit.name, "");
  for (const auto* odd : {"", "]", "[", "][", "()", " / "}) {
    EXPECT_EQ(ColumnNameOf(odd).quantity, odd);
  }
}

}  // namespace column_name_test
}  // namespace abbe::settings
