// Rows that were kept from the fit, predicted by it: whether the estimate says true things of what
// it has not seen.
//
//   for (const HeldOut& run : HoldOut(5, runs, problem_of)) ...   // every 5th block of each run
//
// The whitened rows of a run are independent, so any of them can be kept back. They are cut into
// blocks of rows / (4 n), at least one; of every n blocks the last is held out. What is left of a
// held-out row at the fit of the others has the variance 1 + j C j': its own noise and what the fit
// does not know. `expected` is the sum of these; chi_square / expected is near 1 when all is stated
// truly, whatever the number of rows. A loss is not applied: outliers count in full.
// Failure: InputError for n below 2 or above the rows of a run; NumericalError when the fit of the
// others does not settle.
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
  double rms = 0.0;  // of what is left, in standard deviations of the row's own noise
};

// The problem that belongs to some runs: blocks of runs before sources, one source for each run.
using ProblemOf =
    std::function<estimation::Problem(const std::vector<simulation::SimulatedRun>& runs)>;

std::vector<HeldOut> HoldOut(int n, const std::vector<simulation::SimulatedRun>& runs,
                             const ProblemOf& problem_of);

}  // namespace abbe::fusion
