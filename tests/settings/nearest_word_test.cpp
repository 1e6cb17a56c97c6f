#include "settings/nearest_word.h"

#include <gtest/gtest.h>

namespace abbe::settings {
namespace nearest_word_test {

TEST(NearestWord, TakesTheFewestEdits) {
  const std::vector<std::string> known{"range_um", "position_mm", "unit", "rotation"};
  EXPECT_EQ(NearestWord("range_mm", known), "range_um");         // one letter changed
  EXPECT_EQ(NearestWord("rang_um", known), "range_um");          // one lost
  EXPECT_EQ(NearestWord("positions_mm", known), "position_mm");  // one too many
  EXPECT_EQ(NearestWord("uint", known), "unit");                 // two swapped
  EXPECT_EQ(NearestWord("rotation", known), "rotation");
}

// A swap counts once: "ab" is nearer to "ba" (1) than to "bc" (2).
TEST(NearestWord, CountsASwapOnce) {
  EXPECT_EQ(NearestWord("ab", {"bc", "ba"}), "ba");
  EXPECT_EQ(NearestWord("abcd", {"xyzd", "badc"}), "badc");  // two swaps against three changes
}

TEST(NearestWord, TakesTheFirstOfEquals) { EXPECT_EQ(NearestWord("a", {"b", "c"}), "b"); }

TEST(NearestWord, KnowsNothingFromNothing) {
  EXPECT_EQ(NearestWord("a", {}), "");
  EXPECT_EQ(NearestWord("", {"long", "a"}), "a");
}

}  // namespace nearest_word_test
}  // namespace abbe::settings
