#include "estimation/monte_carlo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "failure/failure.h"
#include "failure/interruption.h"
#include "random/counter_random.h"

namespace abbe::estimation {
namespace monte_carlo_test {

using random::CounterRandom;

// The additive model of JCGM 101, 9.2: the sum of four inputs.
template <class Input>
MonteCarloModel SumOfFour(Input input) {
  return [input](std::uint64_t draw, std::span<double> out) {
    out[0] = 0.0;
    for (std::uint64_t i = 0; i < 4; ++i) out[0] += input(CounterRandom(9, i), draw);
  };
}

const MonteCarloModel kNormals =
    SumOfFour([](const CounterRandom& r, std::uint64_t draw) { return r.Normal(draw); });

struct Ended {};

TEST(MonteCarlo, EndsBetweenItsStepsWhenTheProcessAsks) {
  AskBetweenSteps([] { throw Ended{}; });
  EXPECT_THROW(PropagateDistributions(1, kNormals), Ended);
  AskBetweenSteps(nullptr);
  EXPECT_TRUE(PropagateDistributions(1, kNormals).stabilised);
}

TEST(MonteCarlo, FourNormalsOfJcgm101Clause922) {
  const auto result = PropagateDistributions(1, kNormals);
  ASSERT_TRUE(result.stabilised);
  const auto& out = result.outputs[0];
  EXPECT_DOUBLE_EQ(out.tolerance, 0.05);  // u = 20 * 10^-1
  EXPECT_NEAR(out.mean, 0.0, out.tolerance);
  EXPECT_NEAR(out.standard_uncertainty, 2.0, out.tolerance);
  EXPECT_NEAR(out.low, -3.92, out.tolerance);
  EXPECT_NEAR(out.high, 3.92, out.tolerance);
}

TEST(MonteCarlo, FourRectangularsOfJcgm101Clause923) {
  const double half = std::sqrt(3.0);  // standard deviation 1
  const auto result =
      PropagateDistributions(1, SumOfFour([half](const CounterRandom& r, std::uint64_t draw) {
                               return r.Uniform(draw, -half, half);
                             }),
                             {.significant_digits = 3});
  ASSERT_TRUE(result.stabilised);
  const auto& out = result.outputs[0];
  EXPECT_DOUBLE_EQ(out.tolerance, 0.005);
  EXPECT_GE(result.draws, 200'000u);  // Table 3 of the clause took 1.02e6 to the same tolerance
  // The clause's analytic ends are +-3.88; GUM first order would give 3.92.
  EXPECT_NEAR(out.standard_uncertainty, 2.0, out.tolerance);
  EXPECT_NEAR(out.low, -3.88, 2.0 * out.tolerance);
  EXPECT_NEAR(out.high, 3.88, 2.0 * out.tolerance);
}

TEST(MonteCarlo, OneWideRectangularOfJcgm101Clause924) {
  // One input ten times as wide: u = 10.15, interval +-17.0 (9.2.4, Table 4).
  const double half = std::sqrt(3.0);
  const auto result = PropagateDistributions(1, [&](std::uint64_t draw, std::span<double> out) {
    out[0] = 10.0 * CounterRandom(4, 0).Uniform(draw, -half, half);
    for (std::uint64_t i = 1; i < 4; ++i) out[0] += CounterRandom(4, i).Uniform(draw, -half, half);
  });
  ASSERT_TRUE(result.stabilised);
  const auto& out = result.outputs[0];
  EXPECT_NEAR(out.standard_uncertainty, 10.1, 2.0 * out.tolerance);
  EXPECT_NEAR(out.low, -17.0, 2.0 * out.tolerance);
  EXPECT_NEAR(out.high, 17.0, 2.0 * out.tolerance);
}

TEST(MonteCarlo, MoreDigitsTakeMoreDraws) {
  const auto coarse = PropagateDistributions(1, kNormals, {.significant_digits = 1});
  const auto fine = PropagateDistributions(1, kNormals, {.significant_digits = 3});
  EXPECT_EQ(coarse.draws, 100'000u);  // ten blocks are the fewest that show their spread well
  EXPECT_GT(fine.draws, coarse.draws);
}

TEST(MonteCarlo, SaysWhenItHasNotSettled) {
  const auto result =
      PropagateDistributions(1, kNormals, {.significant_digits = 4, .max_blocks = 3});
  EXPECT_FALSE(result.stabilised);
  EXPECT_EQ(result.draws, 30'000u);
}

TEST(MonteCarlo, IsTheSameToTheLastBitForAnyNumberOfThreads) {
  const MonteCarloModel model = [](std::uint64_t draw, std::span<double> out) {
    out[0] = CounterRandom(1, 0).Normal(draw);
    out[1] = out[0] * CounterRandom(1, 1).Uniform(draw);
  };
  const auto one = PropagateDistributions(2, model, {.threads = 1});
  for (const int threads : {2, 3}) {
    const auto many = PropagateDistributions(2, model, {.threads = threads});
    ASSERT_EQ(one.draws, many.draws);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(one.outputs[i].mean, many.outputs[i].mean);
      EXPECT_EQ(one.outputs[i].standard_uncertainty, many.outputs[i].standard_uncertainty);
      EXPECT_EQ(one.outputs[i].low, many.outputs[i].low);
      EXPECT_EQ(one.outputs[i].high, many.outputs[i].high);
    }
  }
}

TEST(MonteCarlo, AConstantSettlesAtOnce) {
  const auto result =
      PropagateDistributions(1, [](std::uint64_t, std::span<double> out) { out[0] = 0.1; });
  EXPECT_TRUE(result.stabilised);
  EXPECT_EQ(result.outputs[0].mean, 0.1);
  EXPECT_EQ(result.outputs[0].standard_uncertainty, 0.0);
}

TEST(MonteCarlo, IntervalEndsAreTheRanksOfTheGuide) {
  // JCGM 101, 7.7.2 with M = 100, p = 0.95: q = 95, r = 3, the interval is [y_(3), y_(98)].
  std::vector<double> draws(100);
  for (int i = 0; i < 100; ++i) draws[i] = (i * 37) % 100 + 1;
  const auto out = SummariseDraws(draws);
  EXPECT_EQ(out.low, 3.0);
  EXPECT_EQ(out.high, 98.0);
  EXPECT_EQ(out.mean, 50.5);
}

TEST(MonteCarlo, NamesTheDrawThatIsNotFinite) {
  try {
    PropagateDistributions(1, [](std::uint64_t draw, std::span<double> out) {
      out[0] = draw == 123 ? std::log(-1.0) : 0.0;
    });
    FAIL();
  } catch (const NumericalError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("output 0 of draw 123 is not finite"));
  }
}

TEST(MonteCarlo, PassesOnWhatTheModelThrows) {
  EXPECT_THROW(PropagateDistributions(
                   1, [](std::uint64_t, std::span<double>) { throw std::domain_error("no"); }),
               std::domain_error);
}

}  // namespace monte_carlo_test
}  // namespace abbe::estimation
