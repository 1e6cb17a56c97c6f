#include "fusion/marginal.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "estimation/weak_directions.h"

namespace abbe::fusion {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd MarginalFactor(const MatrixXd& information, const std::vector<int>& columns) {
  std::vector<bool> asked(information.rows(), false);
  for (const int column : columns) asked[column] = true;
  std::vector<int> order;
  for (int i = 0; i < information.rows(); ++i) {
    if (!asked[i] && information(i, i) > 0.0) order.push_back(i);
  }
  order.insert(order.end(), columns.begin(), columns.end());
  const Eigen::LLT<MatrixXd> whole{MatrixXd(information(order, order))};
  if (columns.empty() || whole.info() != Eigen::Success) return {};
  const Index n = columns.size();
  return whole.matrixLLT().bottomRightCorner(n, n).triangularView<Eigen::Lower>();
}

Score WithoutNuisance(const Score& all, const std::vector<int>& kept,
                      const std::vector<int>& nuisance) {
  Score left{all.information(kept, kept), all.score(kept)};
  if (nuisance.empty()) return left;
  const MatrixXd cross = all.information(nuisance, kept);
  const MatrixXd inner = all.information(nuisance, nuisance);
  const MatrixXd taken = inner.completeOrthogonalDecomposition().solve(cross);
  left.information -= cross.transpose() * taken;
  left.score -= taken.transpose() * all.score(nuisance);
  return left;
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
