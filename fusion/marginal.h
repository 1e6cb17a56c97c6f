// The marginal of an information matrix: the information about some parameters with all others as
// nuisance parameters.
//
//   const Eigen::MatrixXd U = MarginalFactor(information, columns);   // lower, U U' = C^-1
//
// C is the covariance of the columns, in their order. One Cholesky factor with the columns last has
// U as its last part: nothing is inverted. Parameters without any information are left out. Shapes:
// information n x n, U as many as columns. Failure: an empty matrix when the information is
// singular to rounding, or a column has none.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::fusion {

Eigen::MatrixXd MarginalFactor(const Eigen::MatrixXd& information, const std::vector<int>& columns);

// What runs say of some parameters, J'WJ and J'Wr, with others eliminated as nuisance parameters. A
// nuisance parameter without information is left out.
struct Score {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
};
Score WithoutNuisance(const Score& all, const std::vector<int>& kept,
                      const std::vector<int>& nuisance);

// C itself. When MarginalFactor fails, undetermined directions contribute no variance.
Eigen::MatrixXd MarginalCovariance(const Eigen::MatrixXd& information,
                                   const std::vector<int>& columns);

}  // namespace abbe::fusion
