#include "standards/chi_squared.h"

#include <boost/math/distributions/chi_squared.hpp>

namespace abbe::standards {

double ChiSquaredExceeds(double value, double freedom) {
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), value));
}

double ChiSquaredQuantile(double share, double freedom) {
  return boost::math::quantile(boost::math::chi_squared(freedom), share);
}

}  // namespace abbe::standards
