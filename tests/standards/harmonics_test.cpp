#include "standards/harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "failure/failure.h"
#include "standards/closed_profile_filter.h"

namespace abbe::standards {
namespace harmonics_test {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRounding = 1e-13;

std::vector<double> EvenAngles(int n, int turns = 1) {
  std::vector<double> angles(static_cast<std::size_t>(n) * turns);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    angles[i] = kTurn * static_cast<double>(i) / n - 4.0;
  }
  return angles;
}

TEST(Harmonics, AreTheDiscreteFourierTransformAtEvenSpacing) {
  const std::vector<double> angles = EvenAngles(16);
  std::vector<double> values(16);
  for (int i = 0; i < 16; ++i) values[i] = (i * 37) % 11 - 5;
  const HarmonicFit fit = FitHarmonics(angles, values, 5);
  for (int n = 1; n <= 5; ++n) {
    double cosine = 0, sine = 0;
    for (std::size_t i = 0; i < 16; ++i) {
      cosine += values[i] * std::cos(n * angles[i]) / 8;
      sine += values[i] * std::sin(n * angles[i]) / 8;
    }
    EXPECT_NEAR(fit.Order(n).cosine, cosine, kRounding);
    EXPECT_NEAR(fit.Order(n).sine, sine, kRounding);
  }
}

TEST(Harmonics, RecoverASumAtUnevenAngles) {
  std::vector<double> angles, values;
  const auto sum = [](double t) { return 5 + 3 * std::cos(t - 0.4) - 2 * std::cos(3 * t - 1.1); };
  for (int i = 0; i < 40; ++i) {
    angles.push_back(std::fmod(2.399963 * i, kTurn) + (i % 3) * kTurn);  // golden angle
    values.push_back(sum(angles.back()));
  }
  const HarmonicFit fit = FitHarmonics(angles, values, 4);
  EXPECT_NEAR(fit.mean, 5, kRounding);
  EXPECT_NEAR(fit.Order(1).Amplitude(), 3, kRounding);
  EXPECT_NEAR(fit.Order(1).Phase(), 0.4, kRounding);
  EXPECT_NEAR(fit.Order(3).Amplitude(), 2, kRounding);
  EXPECT_NEAR(fit.Order(2).Amplitude(), 0, kRounding);
  EXPECT_NEAR(fit.rms, 0, kRounding);
  EXPECT_NEAR(fit.At(0.7), sum(0.7), kRounding);
}

TEST(Harmonics, RefuseWhatDoesNotDetermineThem) {
  const std::vector<double> three{0, 1, 2};
  EXPECT_THROW(FitHarmonics(three, three, 2), InputError);
  EXPECT_THROW(FitHarmonics(three, std::vector{0., 1.}, 1), InputError);
  EXPECT_THROW(FitHarmonics(three, std::vector{0., 1., std::nan("")}, 1), InputError);
  EXPECT_THROW(FitHarmonics(std::vector{1., 1., 1.}, three, 1), NumericalError);
}

// ISO 16610-21: transmission exp(-ln 2 (n / cutoff)^2), one half at the cutoff.
TEST(ClosedProfileFilter, PassesWavesAsTheStandardSays) {
  const std::vector<double> angles = EvenAngles(720, 2);
  for (const int order : {0, 5, 15, 30}) {
    std::vector<double> wave;
    wave.reserve(angles.size());
    for (const double t : angles) wave.push_back(std::cos(order * t));
    const std::vector<double> smooth = FilterClosedProfile(angles, wave, 15.0);
    const double transmission = std::exp(-std::numbers::ln2 * order * order / 225.0);
    for (std::size_t i = 0; i < angles.size(); ++i) {
      // The bell is cut off at 3.3 widths: exp(-pi 3.3^2) = 1.4e-15, times the 720 readings.
      EXPECT_NEAR(smooth[i], transmission * wave[i], 1e-12);
    }
  }
}

TEST(ClosedProfileFilter, ACutoffBelowOneTurnAveragesNearlyAll) {
  const std::vector<double> angles = EvenAngles(90);
  std::vector<double> wave;
  wave.reserve(angles.size());
  for (const double t : angles) wave.push_back(1 + std::cos(t));
  // At a cutoff of 0.05 the bell is flat to exp(-pi (pi / (0.47 * 40 pi))^2) = 1 - 9e-3 over a
  // turn.
  for (const double one : FilterClosedProfile(angles, wave, 0.05)) EXPECT_NEAR(one, 1, 0.01);
}

TEST(ClosedProfileFilter, RefusesNonsense) {
  EXPECT_THROW(FilterClosedProfile(std::vector{0.}, std::vector{0.}, 0.0), InputError);
  EXPECT_THROW(FilterClosedProfile(std::vector{0.}, std::vector{0., 1.}, 5.0), InputError);
  EXPECT_THROW(FilterClosedProfile(std::vector{0.}, std::vector{std::nan("")}, 5.0), InputError);
}

}  // namespace harmonics_test
}  // namespace abbe::standards
