// A run of the linkage without causes: its angles and the positions of the axes (correction.h).
#pragma once

#include "simulation/correction.h"

namespace abbe::simulation {

Correction CorrectLinkage(const recording::Recording& recording,
                          const std::vector<ModelledCause>& causes, const Origin& origin,
                          const Instruments& on);

}  // namespace abbe::simulation
