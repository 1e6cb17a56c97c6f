// The trace of a run of the head: a sweep, a standstill or gap steps.
//
// The swept axis heads as its column `direction` says, not as the last difference: at the end of a
// pass it overruns. Failure: that of simulation/trace.h.
#pragma once

#include "recording/recording.h"
#include "simulation/sweep/sweep_run.h"
#include "simulation/trace.h"

namespace abbe::simulation {

Trace TraceOf(const recording::Recording& recording, const SweepRun& run);

}  // namespace abbe::simulation
