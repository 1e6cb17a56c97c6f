// Combinations of parameters that the data do not determine, by name.
//
// Background: D = J'J, J the Jacobian of the data whitened by the noise, is the information of the
// data: along a direction v the data alone give a standard deviation of 1/sqrt(v'Dv). Whether that
// is small is judged against a reference W, the prior knowledge or the wanted accuracy:
//
//   prior        the information of the priors (1 / prior_sd^2, smoothness, ...)
//   tolerance    1 / tolerance^2 of a parameter that has one and has no prior
//   rounding     1e-12 of the parameter's own information: the limit of double precision
//
// The eigenvalues lambda of W^-1/2 D W^-1/2 are the information of the data in units of the
// reference: the variance along the direction falls to 1 / (1 + lambda) of the prior variance. A
// direction with lambda < 1 is weak: the data remove less than half of the variance. D is whitened,
// so the threshold follows the noise.
//
//   for (const WeakDirection& weak : FindWeakDirections(data, prior, tolerances, names)) {
//     fmt::print("{}: {}\n", weak.words, weak.ratio);   // 0.71 arm.a - 0.71 arm.b: 1.00
//   }
//
// Several weak directions span a space whose eigenvectors are arbitrary mixtures; they are rotated
// within it until each has few, large coefficients (quartimax), so that they can be read.
// Units: data and prior 1/unit^2 of the parameters; coefficients in units of each parameter's own
// prior deviation (tolerance, rounding), of length 1. Shapes: n x n, names n.
// Failure: none; what cannot be inverted is infinite or NaN, as said.
// Source: Bayesian D-optimality, e.g. Chaloner and Verdinelli, Statistical Science 10 (1995);
// quartimax: Neuhaus and Wrigley, British J. Statistical Psychology 7 (1954).
// Validity: normal equations in double precision: a combination whose standard deviation is 10^6
// times that of its parameters one by one counts as undetermined.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace abbe::estimation {

struct WeakDirection {
  enum class Held { kByPrior, kByTolerance, kByNothing };
  Held held = Held::kByNothing;  // what limits the direction without data
  Eigen::VectorXd coefficients;  // n, in units of the reference, length 1, first large one positive
  double information = 0.0;      // lambda
  double ratio = 1.0;            // posterior over prior (or tolerance) standard deviation
  std::string words;             // "0.71 arm.a - 0.71 arm.b"
};

// `tolerances`: n, infinite for none.
std::vector<WeakDirection> FindWeakDirections(const Eigen::MatrixXd& data,
                                              const Eigen::MatrixXd& prior,
                                              const Eigen::VectorXd& tolerances,
                                              const std::vector<std::string>& names);

// Those of them alone that the priors do not determine either: a fraction of the time where hundreds are weak.
std::vector<WeakDirection> FindUndeterminedDirections(const Eigen::MatrixXd& data,
                                                      const Eigen::MatrixXd& prior,
                                                      const Eigen::VectorXd& tolerances,
                                                      const std::vector<std::string>& names);

// The largest coefficients with their names, then the number of the others.
std::string InWords(const Eigen::VectorXd& coefficients, const std::vector<std::string>& names);

// The inverse of data + prior, n x n. Parameters in a direction that neither determines have an
// infinite variance and NaN covariances.
struct PosteriorCovariance {
  Eigen::MatrixXd matrix;
  Eigen::MatrixXd determined;  // without the undetermined directions: finite everywhere
  Eigen::Index undetermined = 0;
};
// `data` + `prior` symmetric, not negative.
PosteriorCovariance InvertInformation(const Eigen::MatrixXd& data, const Eigen::MatrixXd& prior);

// Condition number of the whitened Jacobian with columns scaled to length 1: sqrt of the largest
// over the smallest eigenvalue of the information, its diagonal scaled to 1.
double ScaledCondition(const Eigen::MatrixXd& data);

}  // namespace abbe::estimation
