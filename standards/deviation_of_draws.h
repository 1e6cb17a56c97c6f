// What independent normal draws about zero tell of the standard deviation they come from.
//
//   const DrawnDeviation known = DeviationOfDraws(6.0);
//   const double deviation = known.median * rms;            // of six draws: 1.06 of their rms
//   const double U95 = known.u95 * deviation;               // 0.81 of it: few draws tell little
//
// With the prior 1 / sigma, sigma^2 is the sum of squares over a chi-squared number. The interval
// median (1 -+ u95) contains 95 % of it and is the shortest about the median that does; of few
// draws nearly all of what is left lies above.
// Units: `median` of the root of the mean square of the draws, `u95` of the median. Failure: none;
// fewer than one draw count as one. Validity: `draws` need not be a whole number.
// Source: Box and Tiao, Bayesian Inference in Statistical Analysis (1973), 2.3.
#pragma once

namespace abbe::standards {

struct DrawnDeviation {
  double median, u95;
};

DrawnDeviation DeviationOfDraws(double draws);

}  // namespace abbe::standards
