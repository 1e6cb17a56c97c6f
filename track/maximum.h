// The maximum of a function of a few bounded variables, one after the other by Brent's method.
//
//   const Eigen::VectorXd best = Maximum(log_likelihood, start, low, high, 2);
//
// Shapes: n each. Failure: none; a value that is not finite counts as the least. Source: Brent,
// Algorithms for Minimization without Derivatives (1973), by Boost.Math. Validity: one maximum
// along each variable; to some hundredths of the range, as logarithms of lags and sizes need.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace abbe::track {

Eigen::VectorXd Maximum(const std::function<double(const Eigen::VectorXd&)>& function,
                        Eigen::VectorXd start, const Eigen::VectorXd& low,
                        const Eigen::VectorXd& high, int rounds);

}  // namespace abbe::track
