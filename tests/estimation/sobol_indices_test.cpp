#include "estimation/sobol_indices.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::estimation {
namespace sobol_indices_test {

using random::CounterRandom;
constexpr double kPi = std::numbers::pi;

SobolDraw UniformDraws(std::uint64_t seed, double low, double high) {
  return [=](std::uint64_t draw, std::span<double> x) {
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = CounterRandom(seed, i).Uniform(draw, low, high);
  };
}

SobolDraw NormalDraws(std::uint64_t seed) {
  return [=](std::uint64_t draw, std::span<double> x) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = CounterRandom(seed, i).Normal(draw);
  };
}

// Ishigami, Homma (1990): sin x1 + a sin^2 x2 + b x3^4 sin x1, x uniform in +-pi. Its variance is
// V1 + V2 + V13 in closed form.
struct Ishigami {
  static constexpr double a = 7, b = 0.1;
  static constexpr double pi4 = kPi * kPi * kPi * kPi;
  static constexpr double v1 = (1 + b * pi4 / 5) * (1 + b * pi4 / 5) / 2;
  static constexpr double v2 = a * a / 8;
  static constexpr double v13 = 8 * b * b * pi4 * pi4 / 225;
  static constexpr double v = v1 + v2 + v13;
  static constexpr std::array<double, 3> first{v1 / v, v2 / v, 0};
  static constexpr std::array<double, 3> total{(v1 + v13) / v, v2 / v, v13 / v};

  static void Run(std::span<const double> x, std::span<double> y) {
    const double s = std::sin(x[1]);
    y[0] = std::sin(x[0]) + a * s * s + b * std::pow(x[2], 4) * std::sin(x[0]);
  }
};

// Five standard uncertainties: one of six would miss that once in 300 000 seeds.
TEST(SobolIndices, OfIshigamiAreTheClosedForm) {
  const SobolResult result =
      SobolIndices(3, 1, UniformDraws(1, -kPi, kPi), Ishigami::Run, {.draws = 1 << 18});
  EXPECT_NEAR(result.variance, Ishigami::v, 0.01 * Ishigami::v);
  for (std::size_t i = 0; i < 3; ++i) {
    const SobolIndex& index = result.inputs[i];
    EXPECT_NEAR(index.first, Ishigami::first[i], 5 * index.first_uncertainty) << i;
    EXPECT_NEAR(index.total, Ishigami::total[i], 5 * index.total_uncertainty) << i;
    EXPECT_LT(index.first_uncertainty, 0.005);  // about 2 / sqrt(draws)
    EXPECT_LT(index.total_uncertainty, 0.005);
  }
}

// Over 200 seeds the pulls have mean 0 and variance 1, each within four standard deviations of what
// 200 normal numbers have. The fourth power of x3 makes the draws heavy-tailed, hence 2048 of them.
TEST(SobolIndices, AreAsUncertainAsTheySay) {
  constexpr int kSeeds = 200;
  std::array<double, 6> sum{}, square{};
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto result =
        SobolIndices(3, 1, UniformDraws(seed, -kPi, kPi), Ishigami::Run, {.draws = 2048});
    for (std::size_t i = 0; i < 3; ++i) {
      const SobolIndex& index = result.inputs[i];
      const double first = (index.first - Ishigami::first[i]) / index.first_uncertainty;
      const double total = (index.total - Ishigami::total[i]) / index.total_uncertainty;
      sum[i] += first, square[i] += first * first;
      sum[i + 3] += total, square[i + 3] += total * total;
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(sum[i] / kSeeds, 0, 4 / std::sqrt(kSeeds)) << i;
    EXPECT_NEAR(square[i] / kSeeds, 1, 4 * std::sqrt(2.0 / kSeeds)) << i;
  }
}

// Two outputs y = C x of three normal inputs: the share of input i is its squared column over all;
// no input works together with another, and an output far from zero changes nothing.
TEST(SobolIndices, OfALinearModelAreTheSharesOfItsColumns) {
  const auto model = [](std::span<const double> x, std::span<double> y) {
    y[0] = 1000 + 3 * x[0] + x[2];
    y[1] = -500 + 4 * x[0] - 2 * x[1];
  };
  const SobolResult result = SobolIndices(3, 2, NormalDraws(2), model, {.draws = 1 << 16});
  EXPECT_NEAR(result.variance, 30, 0.6);
  const std::array<double, 3> shares{25 / 30.0, 4 / 30.0, 1 / 30.0};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(result.inputs[i].first, shares[i], 5 * result.inputs[i].first_uncertainty);
    EXPECT_NEAR(result.inputs[i].total, shares[i], 5 * result.inputs[i].total_uncertainty);
    EXPECT_LT(result.inputs[i].first_uncertainty, 0.01);
  }
}

TEST(SobolIndices, AreTheSameForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    return SobolIndices(3, 1, UniformDraws(9, -kPi, kPi), Ishigami::Run,
                        {.draws = 5001, .threads = threads});
  };
  const SobolResult one = run(1), four = run(4);
  EXPECT_EQ(one.variance, four.variance);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(one.inputs[i].first, four.inputs[i].first);
    EXPECT_EQ(one.inputs[i].total, four.inputs[i].total);
    EXPECT_EQ(one.inputs[i].total_uncertainty, four.inputs[i].total_uncertainty);
  }
}

TEST(SobolIndices, RefuseWhatHasNoVariance) {
  const auto constant = [](std::span<const double>, std::span<double> y) { y[0] = 1; };
  const auto nan = [](std::span<const double> x, std::span<double> y) { y[0] = std::sqrt(x[0]); };
  EXPECT_THROW(SobolIndices(1, 1, NormalDraws(1), constant), NumericalError);
  EXPECT_THROW(SobolIndices(1, 1, NormalDraws(1), nan), NumericalError);
  EXPECT_THROW(SobolIndices(3, 1, NormalDraws(1), Ishigami::Run, {.draws = 1}), NumericalError);
}

}  // namespace sobol_indices_test
}  // namespace abbe::estimation
