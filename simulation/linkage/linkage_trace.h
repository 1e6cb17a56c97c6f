// The trace of a run of a linkage: its pivots, its links and the way of its ball.
//
// Frames: M and B, as linkage_rows.h says.
// Units: m, rad, s. Shapes: one column a pose of the run.
// Failure: that of simulation/trace.h.
// Source: own.
// Validity: between two rows the axes go straight, an arm as nobody knows.
#pragma once

#include "recording/recording.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// `run`: of the recording, as the simulation takes it.
Trace TraceOf(const recording::Recording& recording, const LinkageRun& run,
              const LinkageSimulation& linkage);
// `axes` are where the instrument finds the ball; how the arm went from pose to pose is not known.
Trace ArmTraceOf(const recording::Recording& recording, const LinkageRun& run,
                 const LinkageSimulation& linkage);

}  // namespace abbe::simulation
