// Why a run contradicts the others: with a mounting, or an instrument, of its own it agrees with
// them.
//
//   const auto own = BlocksOfItsOwn(runs, 2, Suspect::kMounting, model);
//   if (own) runs[2].blocks = *own;             // "target_tilt.top of out/sweep_Z.csv"
//
// Units: those of the blocks. Shapes: the blocks of one run.
// Failure: none; nothing where the run shares no such block with another.
// Source: own.
// Validity: blocks with the same name are the same thing.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "estimation/parameter.h"
#include "machine/volumetric_model.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

enum class Suspect { kNone, kMounting, kInstrument };  // kNone: neither helps

// The blocks of `run` where what it shares with others of the suspect has a name of its own.
std::optional<std::vector<estimation::ParameterBlock>> BlocksOfItsOwn(
    const std::vector<simulation::SimulatedRun>& runs, std::size_t run, Suspect suspect,
    const machine::VolumetricModel& model);

}  // namespace abbe::fusion
