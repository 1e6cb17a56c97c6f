#include "estimation/robust_mean.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "estimation/robust_loss.h"
#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::estimation {
namespace robust_mean_test {

using random::CounterRandom;

std::vector<double> NormalSample(std::uint64_t stream, std::size_t n) {
  const CounterRandom noise(20260727, stream);
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = noise.Normal(i);
  return values;
}

double PlainMean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Variance ratio of two estimators over many samples; its relative noise is below sqrt(2 (1 - c^2)
// 2 / n) for estimators of correlation c, here 0.99 and 0.97.
struct Variances {
  double robust = 0.0, plain = 0.0, stated = 0.0;
};

Variances OverSamples(double tuning, int samples, std::size_t n) {
  Variances v;
  for (int s = 0; s < samples; ++s) {
    const auto values = NormalSample(static_cast<std::uint64_t>(s), n);
    const auto robust = HuberMean(values, {.tuning = tuning});
    v.robust += robust.mean * robust.mean / samples;
    v.stated += robust.standard_error * robust.standard_error / samples;
    v.plain += PlainMean(values) * PlainMean(values) / samples;
  }
  return v;
}

// Huber's closed form of the asymptotic efficiency at the normal distribution.
double Efficiency(double k) {
  const double inside = std::erf(k / std::numbers::sqrt2);
  const double density = std::exp(-0.5 * k * k) / std::sqrt(2.0 * std::numbers::pi);
  return inside * inside / (inside - 2.0 * k * density + k * k * (1.0 - inside));
}

TEST(RobustMean, HasTheEfficiencyThatTheHeaderStates) {
  EXPECT_NEAR(Efficiency(1.345), 0.950, 5e-4);  // Huber and Ronchetti's table
  EXPECT_NEAR(Efficiency(2.0), 0.990, 5e-4);
  constexpr int kSamples = 4000;
  for (const double tuning : {1.345, 2.0}) {
    const Variances v = OverSamples(tuning, kSamples, 100);
    const double correlation = std::sqrt(Efficiency(tuning));
    const double noise = 2.0 * std::sqrt((1.0 - correlation * correlation) / kSamples);
    // The scale is estimated from 100 values: its spread costs below 0.2 %.
    EXPECT_NEAR(v.plain / v.robust, Efficiency(tuning), 3.0 * noise + 0.002) << tuning;
  }
}

TEST(RobustMean, StatesItsOwnSpread) {
  constexpr int kSamples = 4000;
  for (const std::size_t n : {10u, 100u}) {
    const Variances v = OverSamples(2.0, kSamples, n);
    // A variance from 4000 samples has a relative standard deviation of sqrt(2/4000) = 2.2 %. With
    // ten values the linearisation of the M-estimate is itself good to some per cent.
    EXPECT_NEAR(v.stated / v.robust, 1.0, 3.0 * std::sqrt(2.0 / kSamples) + 0.4 / double(n)) << n;
  }
}

TEST(RobustMean, KnownScaleStatesTheAsymptoticError) {
  const auto values = NormalSample(7, 50);
  const auto fit = HuberMean(values, {.known_scale = 1.0});
  EXPECT_NEAR(fit.standard_error, 1.0 / std::sqrt(50.0 * Efficiency(2.0)), 1e-12);
}

TEST(RobustMean, TenPerCentOfGrossValuesBiasItByNoMoreThanTheBound) {
  constexpr std::size_t kN = 1000;
  constexpr double kShare = 0.1, kTuning = 2.0;
  const double bound =
      kShare * kTuning / ((1.0 - kShare) * std::erf(kTuning / std::numbers::sqrt2));
  double bias = 0.0;
  constexpr int kSamples = 200;
  for (int s = 0; s < kSamples; ++s) {
    auto values = NormalSample(static_cast<std::uint64_t>(s), kN);
    for (std::size_t i = 0; i < kN / 10; ++i) values[i] = 1e6;
    const auto fit = HuberMean(values, {.known_scale = 1.0});
    EXPECT_GE(fit.outliers, kN / 10);
    bias += fit.mean / kSamples;
  }
  // The bound is the linear part of the bias; the curvature of psi adds 3 % here.
  EXPECT_NEAR(bias, bound, 0.03 * bound + 4.0 / std::sqrt(double(kN) * kSamples));
}

TEST(RobustMean, IsExactForConstantData) {
  const std::vector<double> values(1000, 0.1);
  const auto fit = HuberMean(values);
  EXPECT_EQ(fit.mean, 0.1);
  EXPECT_EQ(fit.standard_error, 0.0);
  EXPECT_EQ(fit.outliers, 0u);
}

TEST(RobustMean, NamesTheOneWrongValueAmongEqualOnes) {
  std::vector<double> values(200, 5.0);
  values[17] = 6.0;
  const auto fit = HuberMean(values);
  EXPECT_EQ(fit.mean, 5.0);
  EXPECT_EQ(fit.outliers, 1u);
}

TEST(RobustMean, CoarseReadingsStillHaveAScale) {
  // 60 % of the readings on one step, the rest on its neighbours, one lost.
  std::vector<double> values(101, 1e9);
  for (int i = 0; i < 100; ++i) values[i] = i < 60 ? 0.0 : i < 80 ? 1.0 : -1.0;
  const auto fit = HuberMean(values);
  EXPECT_GT(fit.scale, 0.3);
  EXPECT_LT(fit.scale, 1.5);
  EXPECT_EQ(fit.outliers, 1u);
  EXPECT_LT(std::abs(fit.mean), 0.05);
}

TEST(RobustMean, MovesWithShiftAndScale) {
  auto values = NormalSample(3, 40);
  values[0] = 30.0;
  const auto fit = HuberMean(values);
  for (auto& v : values) v = 1e-6 * v + 0.25;
  const auto moved = HuberMean(values);
  // Rounding of 0.25 + 1e-6 x, and the stop at 1e-10 scales.
  constexpr double kRounding = 1e-15;
  EXPECT_NEAR(moved.mean, 0.25 + 1e-6 * fit.mean, kRounding);
  EXPECT_NEAR(moved.standard_error, 1e-6 * fit.standard_error, kRounding);
  EXPECT_EQ(moved.outliers, 1u);
}

TEST(RobustMean, WeightsByDeviationWhenNothingIsCut) {
  const std::vector<double> values = {1.0, 2.0, 4.0, 3.0};
  const std::vector<double> deviations = {1.0, 0.5, 2.0, 1.0};
  const auto fit = HuberMean(values, deviations, {.tuning = 50.0, .known_scale = 1.0});
  const double weight = 1.0 + 4.0 + 0.25 + 1.0;
  EXPECT_NEAR(fit.mean, (1.0 + 8.0 + 1.0 + 3.0) / weight, 1e-14);
  EXPECT_NEAR(fit.standard_error, 1.0 / std::sqrt(weight), 1e-14);
}

TEST(RobustMean, ThreeValuesGiveThePlainMean) {
  const std::vector<double> values = {1.0, 2.0, 30.0};
  const auto fit = HuberMean(values);
  EXPECT_DOUBLE_EQ(fit.mean, 11.0);
  EXPECT_DOUBLE_EQ(fit.standard_error, std::sqrt((100.0 + 81.0 + 361.0) / 2.0 / 3.0));
  EXPECT_TRUE(std::isinf(HuberMean(std::vector<double>{1.0}).standard_error));
}

TEST(RobustMean, RefusesWhatIsNoSample) {
  EXPECT_THROW(HuberMean(std::vector<double>{}), NumericalError);
  try {
    HuberMean(std::vector<double>{1.0, std::numeric_limits<double>::quiet_NaN()});
    FAIL();
  } catch (const NumericalError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("value 1 of 2 is not finite"));
  }
}

TEST(RobustLoss, WeightIsTheSlopeOfRho) {
  for (const RobustLoss loss : {RobustLoss::None(), RobustLoss::Huber(), RobustLoss::Cauchy()}) {
    for (const double t : {0.1, 1.0, 1.9, 2.1, 10.0, -3.0}) {
      constexpr double kStep = 1e-5;  // error of the central difference: kStep^2 + eps/kStep
      const double slope = (loss.Rho(t + kStep) - loss.Rho(t - kStep)) / (2.0 * kStep);
      EXPECT_NEAR(loss.Weight(t), slope / (2.0 * t), 1e-8) << t;
    }
  }
}

}  // namespace robust_mean_test
}  // namespace abbe::estimation
