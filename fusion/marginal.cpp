#include "fusion/marginal.h"

#include <Eigen/Cholesky>

#include "estimation/weak_directions.h"

namespace abbe::fusion {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd MarginalFactor(const MatrixXd& information, const std::vector<int>& columns) {
  std::vector<bool> asked(static_cast<std::size_t>(information.rows()), false);
  for (const int column : columns) asked[static_cast<std::size_t>(column)] = true;
  std::vector<int> order;
  for (int i = 0; i < static_cast<int>(information.rows()); ++i) {
    if (!asked[static_cast<std::size_t>(i)] && information(i, i) > 0.0) order.push_back(i);
  }
  order.insert(order.end(), columns.begin(), columns.end());
  const Eigen::LLT<MatrixXd> whole{MatrixXd(information(order, order))};
  if (columns.empty() || whole.info() != Eigen::Success) return {};
  const auto n = static_cast<Index>(columns.size());
  return whole.matrixLLT().bottomRightCorner(n, n).triangularView<Eigen::Lower>();
}

MatrixXd MarginalCovariance(const MatrixXd& information, const std::vector<int>& columns) {
  const MatrixXd U = MarginalFactor(information, columns);
  if (U.size() == 0) {
    return estimation::InvertInformation(information,
                                         MatrixXd::Zero(information.rows(), information.cols()))
        .determined(columns, columns);
  }
  const MatrixXd root =
      U.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(U.rows(), U.cols()));
  return root.transpose() * root;
}

}  // namespace abbe::fusion
