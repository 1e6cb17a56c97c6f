// The trace of a run of the head: a sweep, a standstill or gap steps.
//
// The swept axis heads as its column `direction` says, not as the last difference: at the end of a
// pass it overruns.
// Units: m, m/s, s, rad. Shapes: one column a row of the run.
// Failure: that of simulation/trace.h.
// Source: own.
// Validity: every row is a standstill: velocity and acceleration are 0.
#pragma once

#include "recording/recording.h"
#include "simulation/sweep/sweep_run.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// With the part `head`.
Trace TraceOf(const recording::Recording& recording, const SweepRun& run);

}  // namespace abbe::simulation
