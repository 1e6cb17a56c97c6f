#include "standards/deviation_of_draws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "random/counter_random.h"

namespace abbe::standards {
namespace deviation_of_draws_test {

// Chi-squared of two degrees exceeds x with exp(-x / 2).
TEST(DeviationOfDraws, IsTheClosedFormOfTwo) {
  const DrawnDeviation known = DeviationOfDraws(2.0);
  EXPECT_NEAR(known.median, 1.0 / std::sqrt(std::log(2.0)), 1e-9);
  EXPECT_NEAR(known.u95, std::sqrt(std::log(2.0) / -std::log(0.95)) - 1.0, 1e-9);
}

TEST(DeviationOfDraws, IsNormalOfMany) {
  constexpr double kDraws = 1e4;
  const DrawnDeviation known = DeviationOfDraws(kDraws);
  EXPECT_NEAR(known.median, 1.0, 1e-4);
  EXPECT_NEAR(known.u95, 1.96 / std::sqrt(2.0 * kDraws), 1e-5);
}

TEST(DeviationOfDraws, ContainsTheTruthInNineteenOfTwenty) {
  constexpr int kWorlds = 20000;
  for (const int draws : {1, 3, 6, 30}) {
    const DrawnDeviation known = DeviationOfDraws(draws);
    const random::CounterRandom random(11, static_cast<std::uint64_t>(draws));
    int inside = 0;
    for (int world = 0; world < kWorlds; ++world) {
      double squares = 0.0;
      for (int i = 0; i < draws; ++i) {
        squares += std::pow(random.Normal(static_cast<std::uint64_t>(world * draws + i)), 2);
      }
      const double told = known.median * std::sqrt(squares / draws);
      if (std::abs(1.0 - told) < known.u95 * told) ++inside;
    }
    EXPECT_NEAR(inside / static_cast<double>(kWorlds), 0.95, 0.006) << draws;
  }
}

}  // namespace deviation_of_draws_test
}  // namespace abbe::standards
