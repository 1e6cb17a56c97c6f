#include "estimation/variance_parts.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The covariance as it is with these sizes.
struct Covariance {
  MatrixXd inverse;
  VectorXd solved;  // inverse y
  double log_likelihood;
};

Covariance CovarianceWith(const MatrixXd& prior, const std::vector<VariancePart>& parts,
                          const VectorXd& sizes, const VectorXd& y) {
  MatrixXd sum = prior;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    sum += sizes[part] * parts[part].covariance;
  }
  const Eigen::LLT<MatrixXd> factor(sum);
  if (factor.info() != Eigen::Success) {
    throw NumericalError("the covariance of what was read is not positive");
  }
  Covariance now;
  const MatrixXd identity = MatrixXd::Identity(y.size(), y.size());
  now.inverse = factor.solve(identity);
  now.solved = now.inverse * y;
  const double log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  now.log_likelihood = -0.5 * (y.dot(now.solved) + log_determinant);
  return now;
}

}  // namespace

VarianceSizes EstimateVariances(const MatrixXd& prior, const std::vector<VariancePart>& parts,
                                const VectorXd& y) {
  constexpr int kSteps = 40;
  constexpr double kFirst = 0.1;  // of the size that the mean variance of a part is 1 with
  VectorXd sizes(parts.size());
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const double mean = parts[part].covariance.trace() / y.size();
    sizes[part] = std::max(kFirst / mean, parts[part].least);
  }
  for (int step = 0; step < kSteps; ++step) {
    const Covariance now = CovarianceWith(prior, parts, sizes, y);
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const MatrixXd& covariance = parts[part].covariance;
      const double has = std::max(0.0, now.solved.dot(covariance * now.solved));
      const double should = now.inverse.cwiseProduct(covariance).sum();
      sizes[part] = std::max(parts[part].least, sizes[part] * std::sqrt(has / should));
    }
  }
  return {sizes, CovarianceWith(prior, parts, sizes, y).log_likelihood};
}

}  // namespace abbe::estimation
