#include "track/maximum.h"

#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace abbe::track {

Eigen::VectorXd Maximum(const std::function<double(const Eigen::VectorXd&)>& function,
                        Eigen::VectorXd start, const Eigen::VectorXd& low,
                        const Eigen::VectorXd& high, int rounds) {
  constexpr int kBits = 7;
  const auto value = [&](const Eigen::VectorXd& x) {
    const double found = function(x);
    return std::isfinite(found) ? found : -std::numeric_limits<double>::max();
  };
  double best = value(start);
  for (int round = 0; round < rounds; ++round) {
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      Eigen::VectorXd x = start;
      std::uintmax_t evaluations = 20;
      const auto along = [&](double at) {
        x[i] = at;
        return -value(x);
      };
      const auto [at, least] =
          boost::math::tools::brent_find_minima(along, low[i], high[i], kBits, evaluations);
      if (-least <= best) continue;
      best = -least;
      start[i] = at;
    }
  }
  return start;
}

}  // namespace abbe::track
