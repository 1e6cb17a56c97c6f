#include "study/rate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "failure/failure.h"
#include "study/study.h"

namespace abbe::study {
namespace {

// The closed forms of the interval for none and for all: (alpha/2)^(1/n).
TEST(Rate, HasTheIntervalOfClopperAndPearson) {
  const Rate none{.worlds = 100, .met = 0}, all{.worlds = 100, .met = 100};
  EXPECT_EQ(none.Low(), 0.0);
  EXPECT_NEAR(none.High(), 1.0 - std::pow(0.005, 0.01), 1e-12);
  EXPECT_EQ(all.High(), 1.0);
  EXPECT_NEAR(all.Low(), std::pow(0.005, 0.01), 1e-12);
  // SciPy: beta.ppf(0.005, 90, 11), beta.ppf(0.995, 91, 10).
  const Rate most{.worlds = 100, .met = 90};
  EXPECT_NEAR(most.Low(), 0.798046, 1e-6);
  EXPECT_NEAR(most.High(), 0.961804, 1e-6);
}

TEST(Rate, RefutesABoundOnlyOutsideItsInterval) {
  const Rate most{.worlds = 100, .met = 90};
  EXPECT_FALSE((Bound{"", most, 0.95, 1.0}).IsRefuted());
  EXPECT_TRUE((Bound{"", most, 0.97, 1.0}).IsRefuted());
  EXPECT_TRUE((Bound{"", most, 0.0, 0.5}).IsRefuted());
  EXPECT_FALSE((Bound{"", {}, 0.97, 1.0}).IsRefuted());
}

// Counts of a row that was just made are signed, those of one that was read are not.
TEST(RateOf, TakesRowsJustMadeAndRead) {
  const Row made{{"sizes", 3}, {"inside", 2}}, read = Row::parse(made.dump());
  for (const Row& row : {made, read}) {
    const Rate rate = RateOf(row, "sizes", "inside");
    EXPECT_EQ(rate.worlds, 3);
    EXPECT_EQ(rate.met, 2);
  }
}

TEST(RateOf, RefusesWhatIsNoRate) {
  for (const Row& row : {Row{{"sizes", 3}, {"inside", 4}}, Row{{"sizes", 3}, {"inside", -1}},
                         Row{{"sizes", 3}, {"inside", 0.5}}}) {
    EXPECT_THROW(RateOf(row, "sizes", "inside"), InputError);
  }
}

}  // namespace
}  // namespace abbe::study
