// What many independent results say together: means with their standard error, and whether stated
// uncertainties are true.
//
//   Pulls pulls;
//   for (...) pulls.Add(error, u, coverage);   // one number a seed, so that they are independent
//   pulls.ExpectTrueUncertainties();
#pragma once

#include <gtest/gtest.h>

#include <cmath>

namespace abbe {

inline constexpr double k99 = 2.576;  // quantile of the normal distribution, two-sided

// Chi-squared that the joint test of a linkage's parameters may exceed their number by. Errors that
// the data do not see multiply, 1 mrad x 2 mrad x 0.2 m, into as much as the noise leaves in the
// combinations seen best, and a covariance knows nothing of products. Found: 1.0 to 1.7 in 1000
// seeds; at a hundredth of the tolerances nothing.
inline constexpr double kOfProducts = 2.0;

struct Mean {
  double count = 0.0, sum = 0.0, squares = 0.0;
  void Add(double value) {
    count += 1.0;
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / count; }
  double error() const { return std::sqrt((squares / count - mean() * mean()) / (count - 1.0)); }
};

struct Pulls {
  Mean pull, square;  // error / u
  Mean inside;        // whether |error| < U95

  void Add(double error, double u, double coverage) {
    pull.Add(error / u);
    square.Add(error / u * error / u);
    inside.Add(std::abs(error) < coverage * u ? 1.0 : 0.0);
  }

  // Errors no larger than u says: the upper of the bands below.
  void ExpectNoLargerErrors(double k = k99) const {
    const double n = pull.count, q = 2.0 / (9.0 * n);
    EXPECT_NEAR(pull.mean(), 0.0, k / std::sqrt(n));
    EXPECT_LT(square.mean(), std::pow(1.0 - q + k * std::sqrt(q), 3));
    EXPECT_GT(inside.mean(), 0.95 - k * std::sqrt(0.95 * 0.05 / n));
  }
  // Mean 0, variance 1 and coverage 95 % within bands of k standard deviations.
  void ExpectTrueUncertainties(double k = k99) const {
    const double n = pull.count;
    EXPECT_NEAR(pull.mean(), 0.0, k / std::sqrt(n));
    // Chi-squared / n by Wilson and Hilferty.
    const double q = 2.0 / (9.0 * n);
    EXPECT_GT(square.mean(), std::pow(1.0 - q - k * std::sqrt(q), 3));
    EXPECT_LT(square.mean(), std::pow(1.0 - q + k * std::sqrt(q), 3));
    EXPECT_NEAR(inside.mean(), 0.95, k * std::sqrt(0.95 * 0.05 / n));
  }
};

}  // namespace abbe
