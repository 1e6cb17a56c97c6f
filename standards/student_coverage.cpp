#include "standards/student_coverage.h"

#include <boost/math/distributions/students_t.hpp>
#include <limits>

namespace abbe::standards {

double StudentCoverage(double degrees_of_freedom) {
  constexpr double kNormal = 1.959964, kMany = 1e6;
  if (!(degrees_of_freedom > 0.0)) return std::numeric_limits<double>::infinity();
  if (degrees_of_freedom > kMany) return kNormal;
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
}

}  // namespace abbe::standards
