// The coverage factor for 95 % when the standard uncertainty has few degrees of freedom: the
// quantile 0.975 of Student's t (GUM, G.3.2).
//
//   const double U95 = StudentCoverage(3.0) * u;      // 3.18 u
//
// 1.96 for infinite degrees of freedom; infinite for none.
#pragma once

namespace abbe::standards {

double StudentCoverage(double degrees_of_freedom);

// By how much wider that is than for infinite degrees of freedom: of a standard uncertainty times
// it, the factor of normal errors gives the U95.
double StudentWidening(double degrees_of_freedom);

// The value that Student's t exceeds with the probability 1 - `share`, which lies between 0 and 1.
double StudentQuantile(double share, double degrees_of_freedom);

// The probability that Student's t is farther from 0 than `ratio`, on either side.
double StudentTwoSided(double ratio, double degrees_of_freedom);

// The degrees of freedom that a coverage factor states: the inverse of StudentCoverage(), and
// infinite for 2 or less, the factor of normal errors (standards/coverage.h).
double DegreesOfFreedomOf(double coverage);

}  // namespace abbe::standards
