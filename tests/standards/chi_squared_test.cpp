#include "standards/chi_squared.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abbe::standards {
namespace chi_squared_test {

// Two degrees: exp(-x / 2). One: erfc(sqrt(x / 2)).
TEST(ChiSquared, IsTheClosedFormOfOneAndOfTwoDegrees) {
  for (const double x : {0.0, 0.1, 1.0, 5.0, 40.0}) {
    EXPECT_NEAR(ChiSquaredExceeds(x, 2.0), std::exp(-0.5 * x), 1e-14);
    EXPECT_NEAR(ChiSquaredExceeds(x, 1.0), std::erfc(std::sqrt(0.5 * x)), 1e-14);
  }
  EXPECT_NEAR(ChiSquaredQuantile(0.95, 2.0), -2.0 * std::log(0.05), 1e-12);
}

// Abramowitz and Stegun, table 26.8: 7.814 73 for 3 degrees, 18.307 0 for 10, 124.342 for 100.
TEST(ChiSquared, IsThatOfTheTables) {
  EXPECT_NEAR(ChiSquaredQuantile(0.95, 3.0), 7.81473, 5e-6);
  EXPECT_NEAR(ChiSquaredQuantile(0.95, 10.0), 18.3070, 5e-5);
  EXPECT_NEAR(ChiSquaredQuantile(0.95, 100.0), 124.342, 5e-4);
  EXPECT_NEAR(ChiSquaredExceeds(18.3070, 10.0), 0.05, 1e-6);
}

}  // namespace chi_squared_test
}  // namespace abbe::standards
