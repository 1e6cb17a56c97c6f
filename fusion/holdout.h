// Validation by held-out rows: rows left out of a fit, and predicted by it.
//
//   for (const HeldOut& run : HoldOut(5, runs, problem_of)) ...   // every 5th block of each run
//
// The whitened rows of a run are independent, so any of them can be held out. They are cut into
// blocks of rows / (4 n), at least one; of every n blocks the last is held out. The whitened
// residuals r of the held-out rows at the fit of the others have the covariance 1 + J C J': their
// own noise and the uncertainty of the prediction, which they share. chi_square is
// r' (1 + J C J')^-1 r, `expected` the number of rows; the ratio is near 1 when noise and priors
// are stated correctly, also where the others leave something quite open. No robust loss is
// applied: outliers count in full.
// Units: standard deviations of the rows. Shapes: one HeldOut a run, in their order.
// Failure: InputError for n below 2 or above the rows of a run; NumericalError when the fit of the
// others does not converge.
// Source: cross-validation; covariance of a prediction, GUM Supplement 2 (2011) 6.2.
// Validity: first order at the fit; rows whose noise goes on from one to the next predict too well
// unless a block outlasts it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "estimation/problem.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

struct HeldOut {
  std::string name;       // of the run
  Eigen::Index rows = 0;  // held out
  double chi_square = 0.0;
  double expected = 0.0;
  double rms = 0.0;  // of the residuals, in standard deviations of the row's own noise
};

// Makes the problem of some runs: the blocks of the runs first, then one source for each run.
using ProblemOf =
    std::function<estimation::Problem(const std::vector<simulation::SimulatedRun>& runs)>;

// One fit more, without the blocks of all runs.
std::vector<HeldOut> HoldOut(int n, const std::vector<simulation::SimulatedRun>& runs,
                             const ProblemOf& problem_of);

}  // namespace abbe::fusion
