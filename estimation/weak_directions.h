// Which combinations of parameters the data cannot see, by name.
//
// Background: D = J'J, J the Jacobian of the data whitened by the noise, is the information of the
// data: along a direction v the data alone leave a standard deviation of 1/sqrt(v'Dv). Whether that
// is little or much is a question of what was known or is wanted, the reference W:
//
//   prior        the information of the priors (1 / prior_sd^2, smoothness, ...)
//   tolerance    1 / tolerance^2 of a parameter that has one and has no prior
//   rounding     1e-12 of the parameter's own information: below it, double precision sees nothing
//
// In units of the reference, eigenvalues lambda of W^-1/2 D W^-1/2 are what the data add to what
// was known: the variance along the direction falls to 1 / (1 + lambda) of its prior. A direction
// with lambda < 1 is weak: the data take less than half of the variance away. The threshold is tied
// to the noise because D is.
//
//   for (const WeakDirection& weak : FindWeakDirections(data, prior, tolerances, names)) {
//     fmt::print("{}: {}\n", weak.words, weak.ratio);   // 0.71 arm.a - 0.71 arm.b: 1.00
//   }
//
// Several weak directions span a space whose eigenvectors are arbitrary mixtures; they are turned
// within it until each has few, large coefficients (quartimax), so that the words can be read.
// Units: data and prior 1/unit^2 of the parameters; coefficients in units of each parameter's own
// prior deviation (tolerance, rounding), of length 1. Shapes: n x n, names n.
// Failure: none. Source: Bayesian D-optimality, e.g. Chaloner and Verdinelli, Statistical Science
// 10 (1995); quartimax: Neuhaus and Wrigley, British J. Statistical Psychology 7 (1954). Validity:
// normal equations in double precision: a combination that is seen 10^6 times worse than its
// parameters one by one counts as not seen.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace abbe::estimation {

struct WeakDirection {
  enum class Held { kByPrior, kByTolerance, kByNothing };
  Held held = Held::kByNothing;  // what is left when the data say nothing
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

// The largest coefficients with their names, the rest counted.
std::string InWords(const Eigen::VectorXd& coefficients, const std::vector<std::string>& names);

// The inverse of data + prior. Parameters that take part in a direction which neither sees have an
// infinite variance and NaN covariances.
struct PosteriorCovariance {
  Eigen::MatrixXd matrix;
  Eigen::MatrixXd determined;  // the same without the undetermined directions: finite everywhere
  Eigen::Index undetermined = 0;
};
PosteriorCovariance InvertInformation(const Eigen::MatrixXd& data, const Eigen::MatrixXd& prior);

// sqrt of the largest over the smallest eigenvalue of the information, its diagonal scaled to 1.
double ScaledCondition(const Eigen::MatrixXd& data);

}  // namespace abbe::estimation
