// A recording as a linear test of a state: its runs fitted from the state on, linearised there, and
// all that belongs to them alone eliminated.
//
//   const LinearRun run = Linearize(runs, names, state);
//   Measure(run.test, state);
//
// The fit is that of fusion/machine_problem.h with the state in the place of the priors of what it
// knows. Its parameters are the functions of the machine, the instruments and mountings that the
// state holds, and the run's own (base, zeros, mountings without a name), which have the priors of
// the machine file. The noise of the run is what its rows leave over the stated one, where that
// differs by more than four standard deviations (fusion/population_estimate.h).
// Units: SI. Shapes: `names` as the entries of the state, "EXX.c0".
// Failure: InputError where the runs are of another model than the state; NumericalError where the
// fit does not converge.
// Source: Gauss-Newton; a run's own parameters by the Schur complement (fusion/marginal.h).
// Validity: first order at the fit.
#pragma once

#include <string>
#include <vector>

#include "simulation/simulated_run.h"
#include "track/gaussian.h"

namespace abbe::track {

struct LinearRun {
  LinearTest test;
  double noise = 1.0;  // over the stated one
  // What would be left of the rows over their stated noise if the state could be anything.
  double unexplained = 1.0;
};

LinearRun Linearize(std::vector<simulation::SimulatedRun> runs,
                    const std::vector<std::string>& names, const Gaussian& state);

}  // namespace abbe::track
