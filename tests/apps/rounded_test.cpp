#include "apps/rounded.h"

#include <gtest/gtest.h>

#include <limits>

namespace abbe::apps {
namespace rounded_test {

// JCGM 100:2008, 7.2.6: y = 10.05762 ohm with u = 27 milliohm is 10.058.
TEST(Rounded, AsTheGuideRounds) { EXPECT_EQ(PlusMinus(10.05762, 0.027), "10.058 +- 0.027"); }

TEST(Rounded, TwoDigitsOfTheUncertainty) {
  EXPECT_EQ(PlusMinus(31.41593, 0.1234), "31.42 +- 0.12");
  EXPECT_EQ(PlusMinus(31.41593, 1.26), "31.4 +- 1.3");
  EXPECT_EQ(PlusMinus(314.1593, 12.6), "314 +- 13");
  EXPECT_EQ(PlusMinus(314.1593, 126), "314 +- 126");
  EXPECT_EQ(PlusMinus(0.000314159, 0.000000123), "0.00031416 +- 0.00000012");
}

TEST(Rounded, AnUncertaintyThatRoundsUpLosesADecimal) {
  EXPECT_EQ(PlusMinus(1.23456, 0.0994), "1.235 +- 0.099");
  EXPECT_EQ(PlusMinus(1.23456, 0.0996), "1.23 +- 0.10");
  EXPECT_EQ(PlusMinus(1.23456, 0.996), "1.2 +- 1.0");
  EXPECT_EQ(PlusMinus(1.23456, 0.1), "1.23 +- 0.10");
}

TEST(Rounded, ZeroHasNoSign) { EXPECT_EQ(PlusMinus(-0.0004, 0.12), "0.00 +- 0.12"); }

TEST(Rounded, WithoutUncertaintyTheFallbackHolds) {
  EXPECT_EQ(Decimals(0.0)(1.23456), "1.235");
  EXPECT_EQ(Decimals(std::numeric_limits<double>::quiet_NaN(), 1)(1.23456), "1.2");
}

}  // namespace rounded_test
}  // namespace abbe::apps
