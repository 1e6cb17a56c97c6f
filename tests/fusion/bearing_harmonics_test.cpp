#include "fusion/bearing_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

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

// Five turns while the gap wanders by 2 um, remembered for a second of twelve.
TEST(BearingHarmonics, CountWhatTheNoiseRemembers) {
  constexpr int kShafts = 40, kReadings = 1200;
  constexpr double kWander = 2e-6, kStep = 0.01;
  const double kept = std::exp(-kStep / 1.0);
  double squares = 0.0, naive = 0.0;
  int remembered = 0;
  for (int shaft = 0; shaft < kShafts; ++shaft) {
    const random::CounterRandom random(shaft, 6);
    std::vector<double> times, angles, values;
    double off = kWander * random.Normal(2 * kReadings);
    for (int i = 0; i < kReadings; ++i) {
      const double angle = 10.0 * M_PI * i / kReadings;
      times.push_back(kStep * i);
      angles.push_back(angle);
      values.push_back(kMean + kSine * std::sin(angle) + 0.1 * kNoise * random.Normal(2 * i) + off);
      off = kept * off + std::sqrt(1.0 - kept * kept) * kWander * random.Normal(2 * i + 1);
    }
    const auto pull = [&](const BearingHarmonics& fit) {
      return (fit.result.Value("bearing.shaft_sin_1") - kSine) /
             fit.result.Uncertainty("bearing.shaft_sin_1");
    };
    const BearingHarmonics fit = FitBearing(angles, values, {1, 2}, times);
    remembered += fit.memory.has_value() ? 1 : 0;
    squares += std::pow(pull(fit), 2) / kShafts;
    naive += std::pow(pull(FitBearing(angles, values, {1, 2})), 2) / kShafts;
  }
  EXPECT_LT(squares, 1.0 + 3.3 * std::sqrt(2.0 / kShafts));
  EXPECT_GT(naive, 2.0);  // without times
  EXPECT_GT(remembered, kShafts / 2);
}

// A vibration that comes and goes is no drift, however smooth it is from reading to
// reading: what harmonics are is as certain as their residuals say at that length.
TEST(BearingHarmonics, TakeAVibrationForNoDrift) {
  constexpr int kShafts = 40, kReadings = 600;
  double squares = 0.0, largest = 0.0;
  for (int shaft = 0; shaft < kShafts; ++shaft) {
    const random::CounterRandom random(shaft, 7);
    std::vector<double> times, angles, values;
    const double kept = std::exp(-1.0 / 20.0), swing = 2.0 * kept * std::cos(2.0 * M_PI / 22.0);
    double now = 0.0, before = 0.0;
    for (int i = -200; i < kReadings; ++i) {
      const double next = swing * now - kept * kept * before + kNoise * random.Normal(i + 200);
      before = std::exchange(now, next);
      if (i < 0) continue;
      const double angle = 2.5 * M_PI * i / kReadings;
      times.push_back(0.01 * i);
      angles.push_back(angle);
      values.push_back(kMean + kSine * std::sin(angle) + now);
    }
    const BearingHarmonics fit = FitBearing(angles, values, {1, 2}, times);
    const double u = fit.result.Uncertainty("bearing.shaft_sin_1");
    squares += std::pow((fit.result.Value("bearing.shaft_sin_1") - kSine) / u, 2) / kShafts;
    largest = std::max(largest, u);
  }
  EXPECT_LT(squares, 1.0 + 3.3 * std::sqrt(2.0 / kShafts));
  EXPECT_LT(largest, 1e-6);
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
