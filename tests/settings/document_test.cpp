// Strict reading: what is accepted, what is refused, and the line and the key that a message names.
#include "settings/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace abbe::settings {
namespace document_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

Table Parse(std::string_view text) { return Document::Parse(text, "m.toml").Root(); }

template <typename Action>
std::string Refusal(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

TEST(DocumentTest, ReadsEachType) {
  const Table root = Parse(
      "name = \"m\"\nreal = 1.5\nwhole = 2\nyes = true\nlist_mm = [1, 2.5]\nwords = [\"a\", "
      "\"b\"]\n");
  EXPECT_EQ(root.Text("name"), "m");
  EXPECT_EQ(root.Number("real"), 1.5);
  EXPECT_EQ(root.Number("whole"), 2.0);  // a whole number is a number
  EXPECT_EQ(root.Integer("whole"), 2);
  EXPECT_TRUE(root.Truth("yes", false));
  EXPECT_THAT(root.Quantities("list_mm", 2), ElementsAre(1e-3, 2.5e-3));
  EXPECT_THAT(root.Texts("words", 0), ElementsAre("a", "b"));
  EXPECT_TRUE(root.Has("name"));
  EXPECT_FALSE(root.Has("nam"));
  root.RefuseUnknown();
}

TEST(DocumentTest, TakesFallbacksForWhatIsAbsent) {
  const Table root = Parse("");
  EXPECT_EQ(root.Text("name", "m"), "m");
  EXPECT_EQ(root.Number("real", {.fallback = 1.5}), 1.5);
  EXPECT_EQ(root.Integer("whole", {.fallback = -2}), -2);
  EXPECT_TRUE(root.Truth("yes", true));
  EXPECT_EQ(root.Choice("side", {"top", "bottom"}), "top");
  EXPECT_THAT(root.Quantities("list_mm", 0, std::vector<double>{3.0}), ElementsAre(3e-3));
  EXPECT_THAT(root.Texts("words", 0, std::vector<std::string>{"z"}), ElementsAre("z"));
  EXPECT_EQ(root.Child("none").Number("deep", {.fallback = 7.0}), 7.0);
  EXPECT_TRUE(root.Children("nothing").empty());
  EXPECT_TRUE(root.Named().empty());
  root.RefuseUnknown();
}

TEST(DocumentTest, ConvertsByTheUnitInTheKey) {
  const Table root = Parse("arm_mm = 10\nfeed_mm_min = 600\nturn_deg = 180\nplain = 3\n");
  EXPECT_DOUBLE_EQ(root.Quantity("arm_mm"), 0.01);
  EXPECT_DOUBLE_EQ(root.Quantity("feed_mm_min"), 0.01);
  EXPECT_DOUBLE_EQ(root.Quantity("turn_deg"), 3.14159265358979323846);
  EXPECT_EQ(root.Quantity("plain"), 3.0);
  EXPECT_EQ(root.Number("arm_mm"), 10.0);
  EXPECT_DOUBLE_EQ(root.Quantity("gap_um", {.fallback = 5.0}), 5e-6);  // in the unit of the key
}

TEST(DocumentTest, HoldsNumbersToTheirBounds) {
  const Table root = Parse("a_mm = 1\nb = -1\n");
  EXPECT_EQ(root.Number("a_mm", {.above = 0.999}), 1.0);
  EXPECT_EQ(root.Number("a_mm", {.at_least = 1.0}), 1.0);
  EXPECT_EQ(root.Number("a_mm", {.at_most = 1.0}), 1.0);
  EXPECT_EQ(Refusal([&] { root.Number("a_mm", {.above = 1.0}); }),
            "m.toml:1: a_mm: is 1 mm, it must be above 1 mm");
  EXPECT_EQ(Refusal([&] { root.Number("a_mm", {.at_least = 1.5}); }),
            "m.toml:1: a_mm: is 1 mm, it must be at least 1.5 mm");
  EXPECT_EQ(Refusal([&] { root.Number("b", {.at_most = -2.0}); }),
            "m.toml:2: b: is -1, it must be at most -2");
}

TEST(DocumentTest, AMessageIsOneLineWhateverItQuotes) {
  const Table root = Parse("form = \"piv\\nots\\u001b[2J\"\n");
  EXPECT_EQ(Refusal([&] { root.Choice("form", {"pivots"}); }),
            "m.toml:1: form: \"piv ots [2J\" is not one of: pivots");
  const std::string broken = Refusal([] { Parse("a = f\n[b]\n"); });
  EXPECT_THAT(broken, StartsWith("m.toml:1: not valid TOML: "));
  EXPECT_EQ(broken.find('\n'), std::string::npos) << broken;
}

TEST(DocumentTest, RefusesAnotherType) {
  const Table root = Parse(
      "text = \"m\"\nnumber = 1.5\ntruth = true\nlist = [1, \"a\"]\ntable = {a = 1}\n"
      "word = [\"a\", 1]\nbig = 9007199254740994\nnot = nan\nendless = inf\nlists = [nan]\n");
  const auto has = [](const std::string& message, std::string_view place, std::string_view part) {
    EXPECT_THAT(message, StartsWith(std::string(place)));
    EXPECT_THAT(message, HasSubstr(std::string(part)));
  };
  has(Refusal([&] { root.Number("text"); }), "m.toml:1: text: ", "must be a number");
  has(Refusal([&] { root.Number("truth"); }), "m.toml:3: truth: ", "must be a number");
  has(Refusal([&] { root.Text("number"); }), "m.toml:2: number: ", "must be a text in quotes");
  has(Refusal([&] { root.Truth("number", true); }), "m.toml:2: number: ", "must be true or false");
  has(Refusal([&] { root.Integer("number"); }), "m.toml:2: number: ", "whole number");
  has(Refusal([&] { root.Integer("big"); }), "m.toml:7: big: ", "whole number");
  has(Refusal([&] { root.Number("not"); }), "m.toml:8: not: ", "finite");
  has(Refusal([&] { root.Number("endless"); }), "m.toml:9: endless: ", "finite");
  has(Refusal([&] { root.Quantities("lists", 1); }), "m.toml:10: lists: ", "a list of 1 numbers");
  has(Refusal([&] { root.Quantities("list", 2); }), "m.toml:4: list: ", "a list of 2 numbers");
  has(Refusal([&] { root.Quantities("list", 3); }), "m.toml:4: list: ", "a list of 3 numbers");
  has(Refusal([&] { root.Quantities("number", 0); }), "m.toml:2: number: ", "a list of numbers");
  has(Refusal([&] { root.Texts("word", 0); }), "m.toml:6: word: ", "a list of texts");
  has(Refusal([&] { root.Texts("word", 3); }), "m.toml:6: word: ", "a list of 3 texts");
  has(Refusal([&] { root.Child("number"); }), "m.toml:2: number: ", "must be a table");
  has(Refusal([&] { root.Children("table"); }), "m.toml:5: table: ", "a list of tables");
  has(Refusal([&] { root.Children("list"); }), "m.toml:4: list: ", "a list of tables");
}

TEST(DocumentTest, NamesWhatIsMissing) {
  const Table root = Parse("[head]\nrange_um = 1\n");
  EXPECT_THAT(Refusal([&] { root.Text("name"); }), HasSubstr("name: is missing"));
  const Table head = root.Child("head");
  EXPECT_EQ(Refusal([&] { head.Number("arm_mm"); }),
            "m.toml:1: head.arm_mm: is missing; it must be a number");
  EXPECT_THAT(Refusal([&] { head.Quantities("a", 2); }), HasSubstr("a list of 2 numbers"));
  EXPECT_THAT(Refusal([&] { head.Texts("a", 2); }), HasSubstr("a list of 2 texts"));
  EXPECT_THAT(Refusal([&] {
                head.Choice("unit", {"top", "side"}, true);
              }),
              HasSubstr("is missing"));
  // A table that is absent has no line.
  EXPECT_EQ(Refusal([&] { root.Child("target").Number("form_nm"); }),
            "m.toml: target.form_nm: is missing; it must be a number");
}

TEST(DocumentTest, ListsWhatMayBeChosen) {
  const Table root = Parse("unit = \"top\"\nside = \"left\"\nnumber = 1\n");
  EXPECT_EQ(root.Choice("unit", {"side", "top"}), "top");
  EXPECT_EQ(Refusal([&] {
              root.Choice("side", {"side", "top"});
            }),
            "m.toml:2: side: \"left\" is not one of: side, top");
  EXPECT_THAT(Refusal([&] { root.Choice("number", {"side"}); }), HasSubstr("text in quotes"));
}

TEST(DocumentTest, RefusesAKeyThatNobodyAskedFor) {
  const Table root = Parse("name = \"m\"\n\n[head]\narm_mm = 1\nrange_mm = 2\n\n[haed]\n");
  root.Text("name");
  const Table head = root.Child("head");
  head.Number("arm_mm");
  head.Number("range_um", {.fallback = 100.0});
  EXPECT_EQ(Refusal([&] { head.RefuseUnknown(); }),
            "m.toml:5: head.range_mm: is not a known key; did you mean \"range_um\"?");
  EXPECT_EQ(Refusal([&] { root.RefuseUnknown(); }),
            "m.toml:7: haed: is not a known key; did you mean \"head\"?");
  // Nothing was asked for: there is no word to offer.
  EXPECT_EQ(Refusal([&] { Parse("a = 1").RefuseUnknown(); }), "m.toml:1: a: is not a known key");
}

TEST(DocumentTest, AsksEachTableOfAnArrayByItself) {
  const Table root = Parse("[[block]]\nat = 1\n[[block]]\nat = 2\nto = 3\n[[block]]\n");
  const std::vector<Table> blocks = root.Children("block");
  ASSERT_EQ(blocks.size(), 3u);
  EXPECT_EQ(blocks[0].Integer("at"), 1);
  EXPECT_EQ(blocks[1].Integer("at"), 2);
  EXPECT_EQ(blocks[1].Integer("to"), 3);
  blocks[0].RefuseUnknown();
  blocks[1].RefuseUnknown();
  EXPECT_EQ(Refusal([&] { blocks[2].Integer("at"); }),
            "m.toml:6: block[2].at: is missing; it must be a number");
  root.RefuseUnknown();
  // The keys of one element are not those of another.
  const Table other = Parse("[[block]]\nat = 1\n[[block]]\nto = 1\n");
  const auto both = other.Children("block");
  both[0].Integer("at");
  both[1].Integer("at", {.fallback = 0.0});
  EXPECT_EQ(Refusal([&] { both[1].RefuseUnknown(); }),
            "m.toml:4: block[1].to: is not a known key; did you mean \"at\"?");
}

TEST(DocumentTest, AcceptsInlineTablesInAnArray) {
  const Table root = Parse("channel = [\n  { name = \"a\" },\n  { nam = \"b\" },\n]\n");
  const auto channels = root.Children("channel");
  ASSERT_EQ(channels.size(), 2u);
  EXPECT_EQ(channels[0].Text("name"), "a");
  EXPECT_EQ(Refusal([&] { channels[1].Text("name"); }),
            "m.toml:3: channel[1].name: is missing; it must be a text in quotes");
}

TEST(DocumentTest, GivesTheTablesThatTheUserNamed) {
  const Table root = Parse(
      "[devices]\nrate_hz = 10\n[devices.shared]\nx = 1\n[devices.tool]\nport = "
      "1\n[devices.mill]\nprt = 2\n");
  const Table devices = root.Child("devices");
  devices.Number("rate_hz");
  devices.Child("shared").Number("x");
  const std::vector<Table> named = devices.Named();
  ASSERT_EQ(named.size(), 2u);
  EXPECT_EQ(named[0].key(), "tool") << "the order is that of the file";
  EXPECT_EQ(named[0].Integer("port"), 1);
  EXPECT_EQ(named[1].key(), "mill");
  named[1].Integer("port", {.fallback = 502.0});
  EXPECT_EQ(Refusal([&] { named[1].RefuseUnknown(); }),
            "m.toml:8: devices.mill.prt: is not a known key; did you mean \"port\"?");
  devices.RefuseUnknown();
  EXPECT_EQ(devices.Named().size(), 2u) << "asking twice gives the same";
}

TEST(DocumentTest, LogsWhatWasAskedFor) {
  const auto document =
      Document::Parse("[devices.head]\nport = 1\n[[devices.head.block]]\nat = 1\n", "m.toml");
  const Table root = document.Root();
  root.Text("name", "none");
  root.Quantity("arm_mm", {.fallback = 10.0});
  root.Truth("dry", false);
  root.Choice("side", {"top", "bottom"});
  root.Quantities("at_mm", 2, std::vector<double>{1.0, 2.5});
  root.Texts("words", 0, std::vector<std::string>{"a", "b"});
  for (const Table& device : root.Child("devices").Named()) {
    device.Integer("port");
    for (const Table& block : device.Children("block")) block.Integer("at");
  }
  const auto& asked = document.requested();
  const auto expect = [&](const std::string& path, std::string_view type, std::string_view unit,
                          std::string_view fallback) {
    ASSERT_TRUE(asked.contains(path)) << path;
    EXPECT_EQ(asked.at(path).type, type) << path;
    EXPECT_EQ(asked.at(path).unit, unit) << path;
    EXPECT_EQ(asked.at(path).fallback, fallback) << path;
  };
  expect("name", "text", "", "\"none\"");
  expect("arm_mm", "number", "mm", "10");
  expect("dry", "truth", "", "false");
  expect("side", "text", "", "\"top\"");
  expect("at_mm", "numbers", "mm", "[1, 2.5]");
  expect("words", "texts", "", "[\"a\", \"b\"]");
  expect("devices", "table", "", "{}");
  expect("devices.[].port", "number", "", "");
  expect("devices.[].block", "tables", "", "[]");
  expect("devices.[].block[].at", "number", "", "");
  EXPECT_EQ(asked.size(), 10u);
}

TEST(DocumentTest, KeepsTheDocumentAlive) {
  const Table head = Document::Parse("[head]\na = 1\n", "m.toml").Root().Child("head");
  EXPECT_EQ(head.Number("a"), 1.0);
}

TEST(DocumentTest, NamesTheLineThatIsNotToml) {
  EXPECT_THAT(Refusal([] { Parse("a = 1\nb = \n"); }), StartsWith("m.toml:2: not valid TOML: "));
  EXPECT_THAT(Refusal([] { Parse("a = 1\na = 2\n"); }), StartsWith("m.toml:2: not valid TOML: "));
  EXPECT_THAT(Refusal([] { Parse("a = 1\n\nb = what\n"); }),
              StartsWith("m.toml:3: not valid TOML: "));
}

TEST(DocumentTest, ReadsFilesAndSaysWhyNot) {
  const auto folder = std::filesystem::temp_directory_path();
  const auto path = folder / ("abbe-document-" + std::to_string(getpid()) + ".toml");
  std::ofstream(path) << "a = 1\nb = oops\n";
  EXPECT_THAT(Refusal([&] { Document::Read(path); }), StartsWith(path.string() + ":2: "));
  std::ofstream(path) << "a = 1\n";
  EXPECT_EQ(Document::Read(path).Root().Number("a"), 1.0);
  EXPECT_EQ(Document::Read(path).name(), path.string());
  std::filesystem::remove(path);
  EXPECT_THAT(Refusal([&] { Document::Read(path); }), HasSubstr("No such file"));
  EXPECT_THAT(Refusal([&] { Document::Read(folder); }), HasSubstr("it is a folder"));
}

TEST(DocumentTest, WritesTheErrorOfItsReader) {
  const Table root = Parse("[head]\na = 1\n");
  const Table head = root.Child("head");
  EXPECT_STREQ(head.Error("a", "is odd").what(), "m.toml:2: head.a: is odd");
  EXPECT_STREQ(head.Error("", "is odd").what(), "m.toml:1: head: is odd");
  EXPECT_STREQ(root.Error("", "is odd").what(), "m.toml:1: is odd");
}

}  // namespace document_test
}  // namespace abbe::settings
