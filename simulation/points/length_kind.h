// Lengths along a line through the volume: step gauges, laser interferometers (length_simulation.h).
#pragma once

#include "simulation/run_kind.h"

namespace abbe::simulation {

const RunKind& LengthKind();

}  // namespace abbe::simulation
