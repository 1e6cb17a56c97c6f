// One error map from recordings as they are, whole or block by block: what `abbe fuse` does with
// its files.
//
//   const FuseReport report = FuseSources(sources, instruments, {});
//
// Frames, units, shapes: fusion/fuse.h.
// Failure: that of the kinds of run (simulation/kinds.h) and of Fuse.
// Source: docs/fuse.md.
// Validity: recordings of one machine that belong together (simulation::RefuseStrangers).
#pragma once

#include <functional>
#include <vector>

#include "fusion/fuse.h"
#include "simulation/instruments.h"
#include "simulation/run_source.h"

namespace abbe::fusion {

// Each source as `as_taken` has it, one at a time, for they are whole then. Empty: as they are,
// several at once.
using AsTaken = std::function<simulation::RunSource(const simulation::RunSource&)>;

// Simulates the sources on the machine, again where other knots are tried, and fuses them. Knots that
// the options state stay.
FuseReport FuseSources(const std::vector<simulation::RunSource>& sources,
                       const simulation::Instruments& instruments, FuseOptions options,
                       const AsTaken& as_taken = {});

}  // namespace abbe::fusion
