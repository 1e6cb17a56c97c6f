// Keys of a text changed one by one, against the text that a person would have written.
#include "settings/toml_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"

namespace abbe::settings {
namespace toml_keys_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string kText =
    "# A mill of the Gerätebau.\n"
    "machine = \"mühle\"  # its name\n"
    "chain = \"[w X Y b Z t]\"\n"
    "\n"
    "[axis.X]  # to the right\n"
    "first_mm = 0.0\n"
    "last_mm=60   # \"µ\" = [1]\n"
    "\n"
    "[head]\n"
    "arms_mm = [10.0, # first\n"
    "           11.0]\n"
    "moves = false\n"
    "places = [\"a\", \"b\"]\n"
    "\n"
    "[[linkage.joint]]\n"
    "d_mm = 1.5\n"
    "[[linkage.joint]]\n"
    "inline = { d_mm = 2.5 }\n"
    "d_mm = 3.5";

std::string Replaced(const std::string& from, const std::string& to) {
  std::string text = kText;
  text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(TomlKeys, AreReadByTheirNames) {
  const TomlKeys keys(kText, "mill.toml");
  EXPECT_EQ(keys.Value("machine"), TomlValue("mühle"));
  EXPECT_EQ(keys.Value("axis.X.first_mm"), TomlValue(0.0));
  EXPECT_EQ(keys.Value("axis.X.last_mm"), TomlValue(std::int64_t{60}));
  EXPECT_EQ(keys.Value("head.arms_mm"), TomlValue(std::vector{10.0, 11.0}));
  EXPECT_EQ(keys.Value("head.moves"), TomlValue(false));
  EXPECT_EQ(keys.Value("head.places"), TomlValue(std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(keys.Value("linkage.joint[1].d_mm"), TomlValue(3.5));
  EXPECT_THAT(keys.Names(),
              ElementsAre("axis.X.first_mm", "axis.X.last_mm", "chain", "head.arms_mm",
                          "head.moves", "head.places", "linkage.joint[0].d_mm",
                          "linkage.joint[1].d_mm", "linkage.joint[1].inline.d_mm", "machine"));
}

TEST(TomlKeys, AreReplacedAndAllElseStays) {
  const TomlKeys keys(kText, "mill.toml");
  EXPECT_EQ(keys.With("machine", "säge").text(), Replaced("\"mühle\"", "\"säge\""));
  EXPECT_EQ(keys.With("axis.X.last_mm", 80.0).text(), Replaced("=60 ", "=80.0 "));
  EXPECT_EQ(keys.With("axis.X.last_mm", std::int64_t{7}).text(), Replaced("=60 ", "=7 "));
  EXPECT_EQ(keys.With("head.arms_mm", std::vector{1.5}).text(),
            Replaced("[10.0, # first\n           11.0]", "[1.5]"));
  EXPECT_EQ(keys.With("head.moves", true).text(), Replaced("false", "true"));
  EXPECT_EQ(keys.With("head.places", std::vector<std::string>{"c \"d\""}).text(),
            Replaced("[\"a\", \"b\"]", "[\"c \\\"d\\\"\"]"));
  EXPECT_EQ(keys.With("linkage.joint[0].d_mm", -1e-9).text(), Replaced("1.5", "-1e-09"));
  EXPECT_EQ(keys.With("linkage.joint[1].inline.d_mm", 4.5).text(), Replaced("2.5", "4.5"));
  EXPECT_EQ(keys.With("linkage.joint[1].d_mm", 4.5).text(), Replaced("3.5", "4.5"));
}

TEST(TomlKeys, AreAddedWhereAPersonWouldWriteThem) {
  const TomlKeys keys(kText, "mill.toml");
  EXPECT_EQ(keys.With("head.range_um", 50.0).text(),
            Replaced("[head]\n", "[head]\nrange_um = 50.0\n") + "\n");
  EXPECT_EQ(keys.With("serial", "17").text(), Replaced("t]\"\n", "t]\"\nserial = \"17\"\n") + "\n");
  EXPECT_EQ(keys.With("limits.EXX_um", 3.0).text(), kText + "\n\n[limits]\nEXX_um = 3.0\n");
  // `axis` has no header of its own.
  EXPECT_EQ(keys.With("axis.lubricated", true).text(), kText + "\n\n[axis]\nlubricated = true\n");
  EXPECT_EQ(keys.With("linkage.joint[0].a_mm", 0.5).text(),
            Replaced("[[linkage.joint]]\n", "[[linkage.joint]]\na_mm = 0.5\n") + "\n");
}

TEST(TomlKeys, AreTheSameWithTheLineEndsOfWindows) {
  const TomlKeys keys("a = 1\r\n[t]\r\nb = 2 # c\r\n", "mill.toml");
  EXPECT_EQ(keys.With("t.b", std::int64_t{3}).text(), "a = 1\r\n[t]\r\nb = 3 # c\r\n");
  EXPECT_EQ(keys.With("t.d", std::int64_t{4}).Value("t.b"), TomlValue(std::int64_t{2}));
}

TEST(TomlKeys, AreRefusedWhereTheyAreNoValues) {
  const TomlKeys keys(kText, "mill.toml");
  EXPECT_THAT([&] { keys.Value("axis.X.last"); },
              ThrowsMessage<InputError>(HasSubstr("mill.toml: axis.X.last: is not there; did you "
                                                  "mean axis.X.last_mm?")));
  EXPECT_THAT([&] { keys.Value("head"); },
              ThrowsMessage<InputError>(HasSubstr("head: is no value")));
  EXPECT_THROW(keys.With("head", 3.0), InputError);
  EXPECT_THROW(keys.With("head.moves.fast", 3.0), InputError);
  EXPECT_THROW(keys.With("linkage.joint[1].inline.a_mm", 3.0), InputError);
  EXPECT_THROW(keys.With("linkage.joint[5].a_mm", 3.0), InputError);
  EXPECT_THROW(keys.With("axis.X.last_mm", std::nan("")), InputError);
  EXPECT_THAT([] { TomlKeys("a = [", "x.toml"); },
              ThrowsMessage<InputError>(HasSubstr("x.toml:1")));
}

}  // namespace toml_keys_test
}  // namespace abbe::settings
