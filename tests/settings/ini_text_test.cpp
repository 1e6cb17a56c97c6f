#include "settings/ini_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"
#include "settings/words.h"

namespace abbe::settings {
namespace ini_text_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

TEST(IniText, KeepsTheFirstOfAKeyWithoutCommentsAndBlanks) {
  const auto values = ParseIni(
      "# of a mill\r\n[AXIS_X]\r\nMIN_LIMIT = -1.5 # mm\r\nMIN_LIMIT = 7\n; none\n\n"
      "[EMC] ; name\nMACHINE = mill#2\nLONG = a \\\n  b = c\n",
      "mill.ini");
  EXPECT_THAT(values, ElementsAre(Pair("AXIS_X.MIN_LIMIT", "-1.5"), Pair("EMC.LONG", "a \\"),
                                  Pair("EMC.MACHINE", "mill#2")));
}

TEST(IniText, RefusesWhatIsNone) {
  for (const char* const text : {"[EMC]\nMACHINE\n", "\nMACHINE = mill\n", "\n[EMC\n"}) {
    EXPECT_THAT([&] { ParseIni(text, "mill.ini"); },
                ThrowsMessage<InputError>(HasSubstr("mill.ini:2: neither [SECTION]")))
        << text;
  }
}

TEST(Words, StandBetweenBlanksAndSeparators) {
  EXPECT_EQ(Trimmed(" \ta b\r\n"), "a b");
  EXPECT_EQ(Trimmed(" \t"), "");
  EXPECT_THAT(WordsOf(" a\tb  c\r"), ElementsAre("a", "b", "c"));
  EXPECT_THAT(PartsOf("a, ,b", ','), ElementsAre("a", "", "b"));
}

}  // namespace ini_text_test
}  // namespace abbe::settings
