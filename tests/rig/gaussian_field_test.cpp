#include "rig/gaussian_field.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>

namespace abbe::rig {
namespace gaussian_field_test {

constexpr double kLength = 0.015;
constexpr double kSd = 2e-6;

// The header's bound on the deviation of the covariance, per coordinate, relative to sd^2.
constexpr double kConstruction = 1e-8;
// Two-sided, so that a correct construction fails once in a thousand choices of seeds.
constexpr double kTail = 5e-4;

void ExpectVariance(double sum_of_squares, int count, double variance) {
  const boost::math::chi_squared distribution(count);
  const double chi2 = sum_of_squares / variance;
  EXPECT_GT(chi2, quantile(distribution, kTail));
  EXPECT_LT(chi2, quantile(complement(distribution, kTail)));
}

// The mean product of two standard normals of correlation r over n draws has the standard deviation
// sqrt((1 + r^2) / n); 3.5 of them leave 5e-4.
void ExpectCorrelation(double sum_of_products, int count, double variance, double correlation) {
  const double band = 3.5 * std::sqrt((1.0 + correlation * correlation) / count);
  EXPECT_NEAR(sum_of_products / (count * variance), correlation, band);
}

// The covariance that independent unit weights give: the sum of the products of the bells.
TEST(GaussianField, BellsMakeTheCovariance) {
  const double amplitude2 = 0.5 / std::sqrt(std::numbers::pi / 2.0);
  for (const double x : {-0.031, 0.0, 0.00371, 0.0549}) {
    for (const double apart : {0.0, 0.2, 0.5, 1.0, 1.7, 3.0}) {
      const BellWindow here(x, kLength), there(x + apart * kLength, kLength);
      double sum = 0.0;
      for (int i = 0; i < BellWindow::kNodes; ++i) {
        const std::int64_t j = here.first + i - there.first;
        if (j >= 0 && j < BellWindow::kNodes) sum += here.bells[i] * there.bells[j];
      }
      EXPECT_NEAR(amplitude2 * sum, std::exp(-0.5 * apart * apart), kConstruction);
    }
  }
}

TEST(GaussianField, BellsAreExponentials) {
  const BellWindow window(0.0123, kLength);
  for (int i = 0; i < BellWindow::kNodes; ++i) {
    const double off = (0.0123 - 0.5 * kLength * static_cast<double>(window.first + i)) / kLength;
    // The recurrence multiplies up to twice `kReach` rounded factors.
    EXPECT_NEAR(window.bells[i] / std::exp(-off * off), 1.0, 100 * 2.2e-16);
  }
}

TEST(GaussianField, ProcessHasItsDeviationAndCorrelation) {
  constexpr int kSeeds = 2000;
  double square = 0.0, near = 0.0, far = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const GaussianProcess process({static_cast<std::uint64_t>(seed), 7}, kSd, kLength, 0.0, 0.06);
    const double value = process(0.0217);
    square += value * value;
    near += value * process(0.0217 + kLength);
    far += value * process(0.0217 + 2.0 * kLength);
  }
  ExpectVariance(square, kSeeds, kSd * kSd);
  ExpectCorrelation(near, kSeeds, kSd * kSd, std::exp(-0.5));
  ExpectCorrelation(far, kSeeds, kSd * kSd, std::exp(-2.0));
}

TEST(GaussianField, ProcessIsTheSameOutsideItsKeptRange) {
  const GaussianProcess narrow({5, 7}, kSd, kLength, 0.0, 0.01);
  const GaussianProcess wide({5, 7}, kSd, kLength, -0.2, 0.2);
  for (const double x : {-0.1, -0.01, 0.005, 0.05, 0.15}) EXPECT_DOUBLE_EQ(narrow(x), wide(x));
}

TEST(GaussianField, SurfaceIsIsotropic) {
  constexpr int kSeeds = 1000;
  const double diagonal = kLength / std::numbers::sqrt2;
  double square = 0.0, along = 0.0, across = 0.0, diagonally = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const GaussianSurface surface({static_cast<std::uint64_t>(seed), 9}, kSd, kLength, -0.01, 0.01);
    const double value = surface(0.003, -0.004);
    square += value * value;
    along += value * surface(0.003 + kLength, -0.004);
    across += value * surface(0.003, -0.004 - kLength);
    diagonally += value * surface(0.003 + diagonal, -0.004 + diagonal);
  }
  ExpectVariance(square, kSeeds, kSd * kSd);
  ExpectCorrelation(along, kSeeds, kSd * kSd, std::exp(-0.5));
  ExpectCorrelation(across, kSeeds, kSd * kSd, std::exp(-0.5));
  ExpectCorrelation(diagonally, kSeeds, kSd * kSd, std::exp(-0.5));
}

TEST(GaussianField, SurfaceIsTheSameOutsideItsKeptRange) {
  const GaussianSurface narrow({5, 9}, kSd, kLength, 0.0, 0.01);
  const GaussianSurface wide({5, 9}, kSd, kLength, -0.2, 0.2);
  for (const double a : {-0.1, 0.005, 0.15}) EXPECT_DOUBLE_EQ(narrow(a, 0.3 * a), wide(a, 0.3 * a));
}

}  // namespace gaussian_field_test
}  // namespace abbe::rig
