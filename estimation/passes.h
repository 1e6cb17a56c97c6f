// The final part of a solve: Gauss-Newton steps on the normal equations until convergence.
//
// Each pass sums J'J and g = J'r over all rows (linearization.h) and takes the step
//
//   -(J'J)^-1 g,   of length sqrt(g' (J'J)^-1 g) in standard uncertainties
//
// damped after Levenberg and Marquardt while a step does not lower the cost. It has converged when
// the length is below `settled` (SolveOptions): no parameter would move by more than that share of
// its standard uncertainty. After the last pass the point is accepted if the length was ever below
// `tolerated` or is below 0.001. Directions that neither data nor priors determine do not move.
// Memory: n x n per source, for any number of rows.
// Failure: NumericalError without convergence; it names the parameter that moves most and the
// source with the largest gradient.
#pragma once

#include <Eigen/Core>

#include "estimation/linearization.h"

namespace abbe::estimation {

struct Minimum {
  Eigen::VectorXd x;
  Linearization at;  // of the problem at x
  int passes = 0;
};

// `at` is the linearization at x, without trouble.
Minimum FindMinimum(const Problem& problem, const Layout& layout, const SolveOptions& options,
                    Eigen::VectorXd x, Linearization at);

}  // namespace abbe::estimation
