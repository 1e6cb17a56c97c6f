// The trace of a run of a linkage: its pivots, its links and the way of its ball.
//
// Failure: that of simulation/trace.h.
#pragma once

#include "recording/recording.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"
#include "simulation/trace.h"

namespace abbe::simulation {

Trace TraceOf(const recording::Recording& recording, const LinkageRun& run,
              const LinkageSimulation& linkage);
// `axes` are where the instrument finds the ball; how the arm went from pose to pose is not known.
Trace ArmTraceOf(const recording::Recording& recording, const LinkageRun& run,
                 const LinkageSimulation& linkage);

}  // namespace abbe::simulation
