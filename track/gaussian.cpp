#include "track/gaussian.h"

#include <Eigen/Dense>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "standards/chi_squared.h"

namespace abbe::track {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSeen = 0.5;        // eigenvalue of B
constexpr double kNegative = -1e-9;  // of correlations, by rounding

// w and B of the header.
struct Whitened {
  MatrixXd information;
  VectorXd score;
};

// `S`: the rows of the root for the entries of the test.
Whitened Whiten(const LinearTest& test, const MatrixXd& S, const Gaussian& state) {
  const VectorXd mean = state.mean(test.entries);
  return {S.transpose() * test.information * S,
          S.transpose() * (test.vector - test.information * mean)};
}

// Upper triangular, of the same covariance.
MatrixXd UpperRootOf(const MatrixXd& root) {
  const MatrixXd backward = root.colwise().reverse();
  return RootOfSum(backward, MatrixXd(root.rows(), 0)).reverse();
}

}  // namespace

MatrixXd RootOf(const MatrixXd& covariance) {
  const VectorXd sd = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const VectorXd inverse = (sd.array() > 0.0).select(sd.cwiseInverse(), 0.0);
  const MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  const Eigen::LDLT<MatrixXd> factor(correlation);
  const VectorXd d = factor.vectorD();
  if (factor.info() != Eigen::Success || !d.allFinite() ||
      d.minCoeff() < kNegative * static_cast<double>(d.size())) {
    throw InputError("a covariance is not positive; fuse the runs again");
  }
  const MatrixXd L = factor.matrixL();
  MatrixXd root = factor.transpositionsP().transpose() * L;
  root *= d.cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return sd.asDiagonal() * root;
}

Gaussian MakeGaussian(const VectorXd& mean, const MatrixXd& covariance) {
  return {mean, UpperRootOf(RootOf(covariance))};
}

MatrixXd RootOfSum(const MatrixXd& a, const MatrixXd& b) {
  const Index n = a.rows();
  MatrixXd both(a.cols() + b.cols(), n);
  both.topRows(a.cols()) = a.transpose();
  both.bottomRows(b.cols()) = b.transpose();
  const Eigen::HouseholderQR<MatrixXd> qr(both);
  const MatrixXd R = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
  return R.transpose();
}

LinearTest WithNoise(LinearTest test, double noise) {
  test.information /= noise * noise;
  test.vector /= noise * noise;
  return test;
}

Agreement AgreementOf(const LinearTest& test, const Gaussian& state) {
  // Whatever the size of the state, a test has as many directions as entries.
  const MatrixXd S = state.root(test.entries, Eigen::all);
  const Whitened seen = Whiten(test, RootOfSum(S, MatrixXd(S.rows(), 0)), state);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(seen.information);
  const VectorXd y = eigen.eigenvectors().transpose() * seen.score;
  Agreement agreement;
  for (Index i = 0; i < y.size(); ++i) {
    const double lambda = eigen.eigenvalues()[i];
    if (!(lambda > kSeen)) continue;
    agreement.statistic += y[i] * y[i] / (lambda * (1.0 + lambda));
    ++agreement.directions;
  }
  if (agreement.directions > 0) {
    agreement.probability = standards::ChiSquaredExceeds(agreement.statistic, agreement.directions);
  }
  return agreement;
}

double Measure(const LinearTest& test, Gaussian& state) {
  Whitened seen = Whiten(test, state.root(test.entries, Eigen::all), state);
  const VectorXd before = state.mean(test.entries);
  const double cost = before.dot(0.5 * test.information * before - test.vector);
  seen.information.diagonal().array() += 1.0;
  const Eigen::LLT<MatrixXd> factor(seen.information);
  const VectorXd half = factor.matrixL().solve(seen.score);
  state.root = factor.matrixL().solve(state.root.transpose()).transpose();  // S R^-T
  state.mean += state.root * half;
  return 0.5 * half.squaredNorm() - cost - factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace abbe::track
