// A Gaussian state in square-root form, and what linear tests say of it: a Kalman filter.
//
//   Gaussian state = MakeGaussian(mean, covariance);
//   state.root = RootOfSum(moved, walked);   // x -> F x + w: F S and a root of the noise
//   const double log = Measure(test, state);
//
// A test is the information about some entries of the state, nuisance parameters eliminated:
// cost(x) = x' L x / 2 - h' x + constant. With the covariance P = S S', B = S_i' L S_i over the
// entries i of the test, and M = 1 + B = R R':
//
//   mean += S M^-1 S_i' (h - L mean_i)        S -> S R^-T        log = (w'M^-1 w - log det M) / 2 - cost(mean)
//
// with w = S_i'(h - L mean_i), whose covariance before the test is B + B^2. The agreement of a test
// is the chi-square of w in the eigenvectors of B whose eigenvalue exceeds 1/2, that is, in what
// the test knows better than, or about as well as, the state.
// Units: those of the state. Shapes: state n, root n x n, test m x m and m for m entries.
// Failure: InputError for a covariance that is not positive semidefinite to rounding.
// Source: Anderson and Moore, Optimal Filtering (1979), 6.5 (square-root filters, information
// form); Teunissen, Testing Theory (2006), for the agreement.
// Validity: linear tests; independent noise of successive tests.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::track {

struct Gaussian {
  Eigen::VectorXd mean;
  Eigen::MatrixXd root;  // S with S S' the covariance

  Eigen::MatrixXd Covariance() const { return root * root.transpose(); }
};

// A root of a covariance, which may be singular.
Eigen::MatrixXd RootOf(const Eigen::MatrixXd& covariance);
// With a root that is upper triangular. Measure keeps zeros at the left end of its rows.
Gaussian MakeGaussian(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance);

// The root of A A' + B B', lower triangular; n x a and n x b.
Eigen::MatrixXd RootOfSum(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

struct LinearTest {
  std::vector<int> entries;  // of the state
  Eigen::MatrixXd information;
  Eigen::VectorXd vector;
};

// The same test with `noise` times its noise.
LinearTest WithNoise(LinearTest test, double noise);

struct Agreement {
  double statistic = 0.0;
  int directions = 0;
  double probability = 1.0;  // of a statistic as large where nothing is wrong
};

// Before the test is taken into the state.
Agreement AgreementOf(const LinearTest& test, const Gaussian& state);

// Log of the marginal likelihood, but for what depends on the test alone.
double Measure(const LinearTest& test, Gaussian& state);

}  // namespace abbe::track
