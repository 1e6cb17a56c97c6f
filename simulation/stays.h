// The rows of a recording in which nothing moves, and what a channel reads in them.
//
//   const Stays stays = StaysOf(recording);
//   const auto noise = estimation::NoiseAtRest(ReadingsIn(recording, "probe_a_um", stays));
//
// A stay is a sequence of good rows of two at least in which no axis goes on by more than a scale
// trembles from one to the next, without a pause. What of them counts, the kind of the run says
// (RunKind::StaysIn).
// Units: SI. Shapes: rows of each stay, ascending.
// Failure: InputError for a value that is not finite. Empty for a recording without axes or good
// rows.
// Validity: a scale trembles by far less than an axis goes on in one row.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "estimation/noise_memory.h"
#include "recording/recording.h"

namespace abbe::simulation {

using Stays = std::vector<std::vector<std::size_t>>;  // rows of each

// In the order of time.
Stays StaysOf(const recording::Recording& recording);
// Without the first `settle` seconds of each, in which an axis settles, and those outside passes.
Stays SettledStays(const recording::Recording& recording, double settle);
// Without time_s rows are a second apart.
std::vector<estimation::Stay> ReadingsIn(const recording::Recording& recording,
                                         const std::string& column, const Stays& stays);

}  // namespace abbe::simulation
