// The kinds of run of the head of five probes.
#pragma once

#include "simulation/run_kind.h"

namespace abbe::simulation {

// The swept axis goes over its travel and back.
const RunKind& SweepKind();
// Nothing moves.
const RunKind& DwellKind();
// At some stations the other axes step to and fro by a known way.
const RunKind& GapStepsKind();

}  // namespace abbe::simulation
