// A sweep without causes: its gaps, and the positions of the axis that is swept (correction.h).
#pragma once

#include "simulation/correction.h"

namespace abbe::simulation {

// Failure: InputError for a machine without a head.
Correction CorrectSweep(const recording::Recording& recording,
                        const std::vector<ModelledCause>& causes, const Origin& origin,
                        const Instruments& on);

}  // namespace abbe::simulation
