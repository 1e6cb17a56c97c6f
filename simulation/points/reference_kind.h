// Runs with a reference instrument: positioning tests (ISO 230-2) and any other way of the axes
// under a grid encoder or a tracker.
//
// Axes that a test does not record stand still (reference_run.h); in a diagnosis a target counts
// with the mean of its readings. Noise: what the recording states, else in a diagnosis how well a
// positioning test repeats (reference_noise.h), else [linkage.noise] of the machine file. A run
// without times has its readings a second apart. Failure: that of reference_run.h; InputError where
// no noise is known.
#pragma once

#include "simulation/run_kind.h"

namespace abbe::simulation {

const RunKind& ReferenceKind();

}  // namespace abbe::simulation
