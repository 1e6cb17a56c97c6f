// The coverage factor for 95 % where the standard uncertainty itself comes from few degrees of
// freedom: the quantile 0.975 of Student's t (GUM, G.3.2).
//
//   const double U95 = StudentCoverage(3.0) * u;      // 3.18 u
//
// Infinitely many degrees of freedom: 1.96. Without any the factor is infinite.
#pragma once

namespace abbe::standards {

double StudentCoverage(double degrees_of_freedom);

}  // namespace abbe::standards
