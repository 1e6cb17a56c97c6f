#include "machine/chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"

namespace abbe::machine {
namespace chain_test {

TEST(Chain, SaysWhichAxesMoveTheWorkpieceAndWhichTheTool) {
  const Chain column = Chain::Parse("[w X Y b Z t]");
  EXPECT_EQ(column.workpiece_axes(), "XY");
  EXPECT_EQ(column.tool_axes(), "Z");
  EXPECT_TRUE(column.CarriesTarget('X'));
  EXPECT_TRUE(column.CarriesTarget('Y'));
  EXPECT_FALSE(column.CarriesTarget('Z'));
}

TEST(Chain, AcceptsTheSpellingsOfTheStandard) {
  for (const char* text : {"[w X' Y' b Z (C) t]", "[wXYbZt]", " [ w X Y' b Z (C1) t ] "}) {
    EXPECT_EQ(Chain::Parse(text).Text(), "[w X Y b Z t]") << text;
  }
}

TEST(Chain, AcceptsEveryConfigurationOfTheModels) {
  for (const char* text :
       {"[w b Y X Z t]", "[w Y b X Z t]", "[w b X Z Y t]", "[w X b Z Y t]", "[w X Y Z b t]"}) {
    EXPECT_EQ(Chain::Parse(text).Text(), text);
  }
}

TEST(Chain, RefusesWhatIsNoChainAndSaysWhy) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"", "brackets"},
      {"w X Y b Z t", "brackets"},
      {"[X Y b Z t]", "begin with w"},
      {"[w X Y b Z]", "end with t"},
      {"[w X Y Z t]", "no b"},
      {"[w X b Y b Z t]", "more than one b"},
      {"[w X Y b X t]", "X twice"},
      {"[w b (C) t]", "none of the axes"},
      {"[w C X Y b Z t]", "rotary axis C"},
      {"[w X Y b Z' t]", "prime on an axis that moves the tool"},
      {"[w ' X Y b Z t]", "follows no axis"},
      {"[w X Y b Z (C t]", "parentheses"},
      {"[w X Y b Q Z t]", "unknown letter 'Q'"},
  };
  for (const auto& [text, reason] : cases) {
    try {
      Chain::Parse(text);
      ADD_FAILURE() << text << " was accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(reason)) << text;
    }
  }
}

TEST(Chain, SaysWhichAxesMoveACarriage) {
  const Chain column = Chain::Parse("[w X Y b Z t]");
  EXPECT_EQ(column.Movers('X'), "YX");
  EXPECT_EQ(column.Movers('Y'), "Y");
  EXPECT_EQ(column.Movers('Z'), "Z");
  EXPECT_EQ(Chain::Parse("[w b Y X Z t]").Movers('Z'), "YXZ");
}

// A table of one axis, a gantry of two: what is not there carries nothing and is moved by nothing.
TEST(Chain, MayLackAxes) {
  const Chain table = Chain::Parse("[w X b t]");
  EXPECT_EQ(table.Text(), "[w X b t]");
  EXPECT_TRUE(table.CarriesTarget('X'));
  EXPECT_FALSE(table.CarriesTarget('Z'));
  EXPECT_EQ(table.Movers('X'), "X");
  EXPECT_EQ(Chain::Parse("[w b Y Z t]").Movers('Z'), "YZ");
}

TEST(Chain, RefusesAnAxisThatIsNotThere) {
  EXPECT_THROW(Chain::Parse("[w X Y b Z t]").CarriesTarget('A'), InputError);
}

}  // namespace chain_test
}  // namespace abbe::machine
