// The part of a solve that decides: steps on the normal equations until nothing is left to go.
//
// Each pass sums J'J and J'r over all rows (linearization.h) and takes the Gauss-Newton step
// -(J'J)^-1 J'r, damped after Levenberg and Marquardt while a step does not lower the cost. Its
// length is measured in standard uncertainties, sqrt(g' (J'J)^-1 g): below `settled` no parameter
// would move by more than that share of its own. Directions that neither data nor priors see stay
// where they are. When no pass is left, a thousandth of an uncertainty is near enough.
// Memory: n x n per source, whatever the number of rows.
// Failure: NumericalError when it does not settle; it names the parameter that moves most and the
// source that pulls most.
#pragma once

#include <Eigen/Core>

#include "estimation/linearization.h"

namespace abbe::estimation {

struct Settled {
  Eigen::VectorXd x;
  Linearization at;  // of the problem at x
  int passes = 0;
};

// `at` is the linearization at x, without trouble.
Settled SettleByPasses(const Problem& problem, const Layout& layout, const SolveOptions& options,
                       Eigen::VectorXd x, Linearization at);

}  // namespace abbe::estimation
