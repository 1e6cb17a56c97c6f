// A turning shaft under gap sensors (shaft_run.h).
//
// Each run has its own zeros; the shaft, its axis and the sensors are the same in all runs of a
// campaign. Noise: u_gap_um of the header, else how well the run repeats from turn to turn
// (shaft_noise.h); the sense of the shaft: shaft_sense, else what the sensors see. Failure: that of
// shaft_run.h; InputError where no noise is known.
#pragma once

#include "simulation/run_kind.h"

namespace abbe::simulation {

const RunKind& ShaftKind();

}  // namespace abbe::simulation
