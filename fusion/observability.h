// Observability: how many combinations of parameters the data of a fit determine, how well, and
// which they do not.
//
//   const Observability seen = Observe(problem, result);
//   seen.rank;                      // 17 of the 24 + 6
//   for (const auto& weak : seen.unseen) fmt::print("{}\n", weak.words);
//
// Background: J is the Jacobian of the data, its rows divided by the noise, its columns multiplied
// by the prior standard deviations; parameters without a prior (the base position in the
// displacement form) are eliminated first. Along the direction of a singular value s the data
// reduce the prior uncertainty to 1 / sqrt(1 + s^2) of it: below s = 1 the direction counts as not
// seen. So the rank depends on noise and priors, not on rounding.
//
//   condition            s_1 / s_n of the columns scaled to length 1
//   noise amplification  s_r^2 / s_1, r the rank (Nahvi and Hollerbach, ICRA 1996): larger is
//                        better; taken over the seen directions, for an unseen one makes it zero
//
// Units: none. Shapes: singular values descending, one a parameter with a prior.
// Source: those above and estimation/weak_directions.h.
// Failure: NumericalError from the residuals.
// Validity: near the solution.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimation/problem.h"
#include "estimation/result.h"

namespace abbe::fusion {

struct Observability {
  Eigen::Index parameters = 0;  // free
  Eigen::Index rank = 0;
  double condition = 0.0;
  double noise_amplification = 0.0;
  Eigen::VectorXd singular_values;  // descending, of the parameters with a prior
  std::vector<estimation::WeakDirection> unseen;
};

// At the solution `result` of `problem`.
Observability Observe(const estimation::Problem& problem, const estimation::Result& result);

}  // namespace abbe::fusion
