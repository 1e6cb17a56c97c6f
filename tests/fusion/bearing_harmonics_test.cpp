#include "fusion/bearing_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::fusion {
namespace bearing_harmonics_test {

constexpr double kMean = 3e-4, kSine = 20e-6, kCosine = -7e-6, kSecond = 2e-6;
constexpr double kNoise = 0.5e-6;

struct Turns {
  std::vector<double> angles, values;
};

// Two turns and a half, unevenly.
Turns Readings(std::size_t count, double noise) {
  const random::CounterRandom random(1, 5);
  Turns turns;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 5.0 * M_PI * random.Uniform(2 * i);
    turns.angles.push_back(angle);
    turns.values.push_back(kMean + kSine * std::sin(angle) + kCosine * std::cos(angle) +
                           kSecond * std::sin(2.0 * angle) + noise * random.Normal(2 * i + 1));
  }
  return turns;
}

TEST(BearingHarmonics, AreThoseOfTheReadings) {
  const Turns turns = Readings(50, 0.0);
  const BearingHarmonics fit = FitBearing(turns.angles, turns.values, {1, 2});
  constexpr double kRounding = 1e-16;  // of 0.3 mm, over a well conditioned fit
  EXPECT_NEAR(fit.result.Value("mean.gap"), kMean, 10 * kRounding);
  EXPECT_NEAR(fit.result.Value("bearing.shaft_sin_1"), kSine, 10 * kRounding);
  EXPECT_NEAR(fit.result.Value("bearing.shaft_cos_1"), kCosine, 10 * kRounding);
  EXPECT_NEAR(fit.Amplitude(1), std::hypot(kSine, kCosine), 10 * kRounding);
  EXPECT_NEAR(fit.Amplitude(2), kSecond, 10 * kRounding);
  EXPECT_NEAR(fit.At(1.0),
              kMean + kSine * std::sin(1.0) + kCosine * std::cos(1.0) + kSecond * std::sin(2.0),
              10 * kRounding);
}

// Even angles: the coefficients have the variance 2 s^2 / n.
TEST(BearingHarmonics, StateTheUncertaintyOfTheirNoise) {
  const Turns turns = Readings(4000, kNoise);
  const BearingHarmonics fit = FitBearing(turns.angles, turns.values, {1, 2});
  const double u = kNoise * std::sqrt(2.0 / 4000);
  EXPECT_NEAR(fit.rms, kNoise, 4.0 * kNoise / std::sqrt(2.0 * 4000));
  EXPECT_NEAR(fit.result.Uncertainty("bearing.shaft_sin_1"), u, 0.1 * u);
  EXPECT_NEAR(fit.result.Value("bearing.shaft_sin_1"), kSine, 4.0 * u);
  // What is left out stands in the residuals.
  const BearingHarmonics first = FitBearing(turns.angles, turns.values, {1});
  EXPECT_NEAR(first.rms, std::hypot(kNoise, kSecond / std::sqrt(2.0)), 0.1 * kNoise);
}

TEST(BearingHarmonics, RefuseWhatTheyCannotTellApart) {
  const Turns few = Readings(5, 0.0);
  EXPECT_THROW(FitBearing(few.angles, few.values, {1, 2}), InputError);
  EXPECT_THROW(FitBearing(few.angles, few.values, {0}), InputError);
  const std::vector<double> standing(20, 0.7), values(20, 1e-3);
  EXPECT_THROW(FitBearing(standing, values, {1}), NumericalError);
}

}  // namespace bearing_harmonics_test
}  // namespace abbe::fusion
