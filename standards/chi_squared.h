// The chi-squared distribution: how likely a sum of squares of so many normal numbers of deviation 1 is.
//
//   if (ChiSquaredExceeds(sum_of_squares, 12) < 0.001) told = true;      // from 32.9 on
//   const double factor = std::sqrt(ChiSquaredQuantile(0.95, 3));        // 2.80: of an ellipsoid in space
//
// `freedom`: degrees of freedom, more than 0, not necessarily a whole number. `value` and the result of
// ChiSquaredQuantile() have no unit, as the numbers that are squared.
// Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 26.4.
#pragma once

namespace abbe::standards {

// The probability of a value larger than `value`, which is 0 or more.
double ChiSquaredExceeds(double value, double freedom);

// The value that is not exceeded with the probability `share`, at least 0 and less than 1.
double ChiSquaredQuantile(double share, double freedom);

}  // namespace abbe::standards
