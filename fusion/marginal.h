// What is known of some unknowns when the others are free: the marginal of an information matrix.
//
//   const Eigen::MatrixXd U = MarginalFactor(information, columns);   // lower, U U' = C^-1
//
// C is the covariance of the columns, in their order. The columns stand last in the order of one
// Cholesky factor, whose last part is U: nothing is inverted. Unknowns without any information are
// left out. Shapes: information n x n, U as many as columns. Failure: an empty matrix when rounding
// hides the rest, or a column has no information.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::fusion {

Eigen::MatrixXd MarginalFactor(const Eigen::MatrixXd& information, const std::vector<int>& columns);

// C itself; directions that nothing determines count as known when MarginalFactor fails.
Eigen::MatrixXd MarginalCovariance(const Eigen::MatrixXd& information,
                                   const std::vector<int>& columns);

}  // namespace abbe::fusion
