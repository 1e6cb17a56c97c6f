// How large the parts of a covariance are, by what was read.
//
//   const VariancePart noise{identity, 1.0};                     // at least as stated
//   const VarianceSizes sizes = EstimateVariances(prior, {noise, {kernel}}, y);
//   sizes.of_parts;     // y ~ N(0, prior + of_parts[0] identity + of_parts[1] kernel)
//
// Maximum of the marginal likelihood by steps that never lower it (minorization): each size times
// the root of what y has of its part over what it should have. `prior`, such as J P J' of unknown
// parameters with the covariance P, is known. Sizes of parts that y does not have fall towards 0.
// Units: the square of those of y over those of a part. Shapes: n x n, y n x 1.
// Failure: NumericalError where the covariance is not positive.
// Source: Zhou, Hu, Zhou, Lange, MM algorithms for variance components models, J. Comput. Graph.
// Stat. 28 (2019), 350, update (2).
// Validity: after kSteps steps, near the maximum only; many parts share what they have in common.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::estimation {

struct VariancePart {
  Eigen::MatrixXd covariance;
  double least = 0.0;  // its size is not less
};

struct VarianceSizes {
  Eigen::VectorXd of_parts;
  double log_likelihood = 0.0;  // without its constant
};

VarianceSizes EstimateVariances(const Eigen::MatrixXd& prior,
                                const std::vector<VariancePart>& parts, const Eigen::VectorXd& y);

}  // namespace abbe::estimation
