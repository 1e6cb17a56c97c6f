// The part of a solve that Ceres does: from a start that may be far away to near the minimum.
//
// Levenberg-Marquardt with the whole Jacobian in memory, on one thread (the order of its sums would
// else depend on the scheduler). What it finds is where passes.h takes over; whether that is a
// minimum is decided there.
// Shapes: x all entries of all blocks, held ones stay. Failure: an exception of a residual other
// than NumericalError passes through; NumericalError and non-finite numbers take the step back.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "estimation/linearization.h"

namespace abbe::estimation {

// Bytes of the Jacobian as Ceres stores it.
std::size_t JacobianBytes(const Problem& problem, const Layout& layout);

// Moves x; returns the iterations it took.
int ApproachMinimum(const Problem& problem, const Layout& layout, const SolveOptions& options,
                    Eigen::VectorXd& x);

}  // namespace abbe::estimation
