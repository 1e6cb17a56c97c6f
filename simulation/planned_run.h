// A run that is only planned, as a recording: a path with the readings that a perfect machine would
// give, so that everything that takes a recording takes it.
//
//   campaign.Add(Planned(path, campaign.instruments()));  // kinds.h
//
// `path` is any recording whose kind can be planned; its positions, times and temperatures stay,
// its readings do not count. The gaps stand in the middle of the range, the angles close the
// nominal linkage; both alternate by the noise of the machine file (+ + - -, which has no
// correlation between neighbours), because the noise of a sweep is taken from its readings. Rows
// with a place get flag 0.
// Frames: as the recording.
// Units: those of a recording. Shapes: rows of the path.
// Failure: InputError for a path without positions, a kind that cannot be planned, an instrument
// that the machine file lacks; NumericalError for a pose out of the linkage's reach.
// Validity: a perfect machine and nominal instruments; what the readings would be with a cause is
// first order about that.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::simulation {

// The steps of a kind that plans:

// A row counts when it has a place.
void FlagPlaces(recording::Recording& path);
// +1 or -1 as if drawn, the same whenever it is asked for: noise in which there is no line.
double MixedSign(std::size_t row, std::size_t channel);
// The values of a column, made where it is missing.
std::vector<double>& ColumnIn(recording::Recording& recording, const std::string& name);

}  // namespace abbe::simulation
