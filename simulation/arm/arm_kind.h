// An arm before a reference instrument (arm_run.h).
//
// Noise of a pose: that of the encoders, of the instrument (ref_u_um or linkage.noise.reference_um)
// and of how the arm repeats (linkage.noise.repeatability_um). Where the instrument stands is found
// from the poses; runs with the same mounting.base in their header share it. Poses far off what the
// arm's geometry makes of all others are left out as outliers (arm_baseline.h); the worst are noted
// with row and size. Failure: that of ReadLinkageRun and of FitArm.
#pragma once

#include "simulation/run_kind.h"

namespace abbe::simulation {

const RunKind& ArmKind();

}  // namespace abbe::simulation
