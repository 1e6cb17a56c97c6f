#include "standards/student_coverage.h"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "standards/coverage.h"

namespace abbe::standards {

double StudentCoverage(double degrees_of_freedom) {
  if (!(degrees_of_freedom > 0.0)) return std::numeric_limits<double>::infinity();
  return StudentQuantile(0.975, degrees_of_freedom);
}

double StudentWidening(double degrees_of_freedom) {
  return StudentCoverage(degrees_of_freedom) /
         StudentCoverage(std::numeric_limits<double>::infinity());
}

double StudentQuantile(double share, double degrees_of_freedom) {
  constexpr double kMany = 1e6;
  if (degrees_of_freedom > kMany) return boost::math::quantile(boost::math::normal(), share);
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), share);
}

double StudentTwoSided(double ratio, double degrees_of_freedom) {
  if (std::isinf(degrees_of_freedom)) return std::erfc(std::abs(ratio) / std::sqrt(2.0));
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::students_t(degrees_of_freedom),
                                                        std::abs(ratio)));
}

double DegreesOfFreedomOf(double coverage) {
  if (coverage <= kCoverage) return std::numeric_limits<double>::infinity();
  // By bisection of the logarithm: the coverage falls as the degrees of freedom grow.
  double low = -7.0, high = 7.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (StudentCoverage(std::exp(middle)) > coverage ? low : high) = middle;
  }
  return std::exp(high);
}

}  // namespace abbe::standards
