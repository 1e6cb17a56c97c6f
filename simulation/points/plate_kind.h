// A hole plate in one or more set-ups (plate_simulation.h), each a run of its own.
#pragma once

#include "simulation/run_kind.h"

namespace abbe::simulation {

const RunKind& PlateKind();

}  // namespace abbe::simulation
