// Loss functions of robust estimation: the influence of large residuals.
//
// With t a residual divided by its standard deviation, an estimator minimises sum rho(t)/2 instead
// of sum t^2/2. `Weight` = rho'(t)/(2t) is the weight of the value in the weighted mean or fit with
// the same solution: 1 near zero, decreasing beyond the tuning constant k.
//
//   loss       rho(t) beyond k       weight beyond k    k for 95 % / 99 % efficiency at normal data
//   kNone      t^2                   1                  -
//   kHuber     2 k |t| - k^2         k / |t|            1.345 / 2.0
//   kCauchy    k^2 log(1 + t^2/k^2)  1 / (1 + t^2/k^2)  2.385 / 4.2  (no bend at k; any t)
//
// Efficiency: the variance of the mean of normal data over that of the robust mean. Huber's loss is
// convex (one minimum) and bounds the influence of a value; with Cauchy's the influence of a gross
// error tends to zero, but there may be several minima: start it near the solution.
// Units: t in standard deviations.
// Failure: none.
// Source: Huber and Ronchetti, Robust Statistics, 2nd ed. (2009), 4.5; Holland and Welsch,
// Communications in Statistics A6 (1977) for the Cauchy constant. When not to use: with fewer than
// about ten values for each parameter a robust loss cannot identify the wrong value.
#pragma once

#include <cmath>

namespace abbe::estimation {

struct RobustLoss {
  enum class Kind { kNone, kHuber, kCauchy };
  Kind kind = Kind::kNone;
  double tuning = 0.0;  // k, in standard deviations

  // t^2.
  static constexpr RobustLoss None() { return {}; }
  // 99 % efficiency at the default.
  static constexpr RobustLoss Huber(double k = 2.0) { return {Kind::kHuber, k}; }
  // 95 % efficiency at the default.
  static constexpr RobustLoss Cauchy(double k = 2.385) { return {Kind::kCauchy, k}; }

  // Loss of a residual.
  double Rho(double t) const {
    const double size = std::abs(t);
    if (kind == Kind::kHuber && size > tuning) return tuning * (2.0 * size - tuning);
    if (kind == Kind::kCauchy) return tuning * tuning * std::log1p(t * t / (tuning * tuning));
    return t * t;
  }

  // In the step of reweighted least squares; 1 for t = 0.
  double Weight(double t) const {
    const double size = std::abs(t);
    if (kind == Kind::kHuber && size > tuning) return tuning / size;
    if (kind == Kind::kCauchy) return 1.0 / (1.0 + t * t / (tuning * tuning));
    return 1.0;
  }
};

}  // namespace abbe::estimation
