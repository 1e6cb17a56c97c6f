#include "standards/deviation_of_draws.h"

#include <algorithm>
#include <cmath>

#include "standards/chi_squared.h"

namespace abbe::standards {

DrawnDeviation DeviationOfDraws(double draws) {
  constexpr double kShare = 0.95;
  constexpr int kHalvings = 40;
  draws = std::max(draws, 1.0);
  const double middle = ChiSquaredQuantile(0.5, draws);
  // In units of the median: sigma < at where chi-squared exceeds middle / at^2.
  const auto below = [&](double at) {
    return at > 0.0 ? ChiSquaredExceeds(middle / (at * at), draws) : 0.0;
  };
  // All that may lie above, and nothing below.
  double least = 0.0, most = std::sqrt(middle / ChiSquaredQuantile(1.0 - kShare, draws));
  for (int i = 0; i < kHalvings; ++i) {
    const double u95 = 0.5 * (least + most);
    (below(1.0 + u95) - below(1.0 - u95) < kShare ? least : most) = u95;
  }
  return {std::sqrt(draws / middle), most};
}

}  // namespace abbe::standards
