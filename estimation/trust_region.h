// The first part of a solve, by Ceres: from a distant start to near the minimum.
//
// Levenberg-Marquardt with the whole Jacobian in memory, on one thread (otherwise the order of its
// sums would depend on the scheduler). passes.h continues from its result and tests convergence.
// Shapes: x has all entries of all blocks; held ones do not change. Failure: NumericalError of a
// residual and values that are not finite reject the step; other exceptions pass through.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "estimation/linearization.h"

namespace abbe::estimation {

// Size of the Jacobian in Ceres, in bytes.
std::size_t JacobianBytes(const Problem& problem, const Layout& layout);

// Moves x; returns the number of iterations.
int ApproachMinimum(const Problem& problem, const Layout& layout, const SolveOptions& options,
                    Eigen::VectorXd& x);

}  // namespace abbe::estimation
