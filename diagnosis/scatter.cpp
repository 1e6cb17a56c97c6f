#include "diagnosis/scatter.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

namespace abbe::diagnosis {

std::vector<Leftover> RunsThatScatter(const Fit& fit) {
  std::vector<Leftover> found;
  const auto& runs = fit.campaign().runs();
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const Eigen::VectorXd& left = fit.LeftOf(run);
    if (left.size() == 0) continue;
    const double stated = left.squaredNorm() * runs[run].excess * runs[run].excess;
    const double chi_square = stated / (kNoiseIsKnown * kNoiseIsKnown);
    const auto rows = static_cast<double>(left.size());
    const boost::math::chi_squared distribution(rows);
    const double chance = boost::math::cdf(boost::math::complement(distribution, chi_square)) *
                          static_cast<double>(runs.size());
    if (chance >= kDoubt) continue;
    found.push_back({kScatter,
                     runs[run].simulated.name,
                     std::sqrt(stated / rows - 1.0),
                     {"times the noise"},
                     chance,
                     0.0});
  }
  return found;
}

}  // namespace abbe::diagnosis
