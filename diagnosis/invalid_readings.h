// Readings that are none: a channel that repeats one value, single readings that jump.
//
//   for (const InvalidReadings& bad : FlagInvalidReadings(recording)) ...     // those rows count no more
//
// Stuck: one value, to the last bit, in at least kLeastStuck rows while another channel of the
// instrument changes in most of them. Outlier: a reading farther from its neighbours than kFar
// times their usual scatter; where the axes stand from the median of the rows of the stay beside
// it, where they move from the cubic through the next four readings of the motion that are no
// outliers, two on either side if there are. Channels: probe_*_um, pivot_*_rad. Units: s since the
// recording began. Rows that have a flag already are passed over; without time_s nothing is said.
// Source of the scatter: 1.4826 times the median absolute deviation.
#pragma once

#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/run_kind.h"

namespace abbe::diagnosis {

inline constexpr std::size_t kLeastStuck = 12;
inline constexpr double kFar = 8.0;

std::vector<simulation::InvalidReadings> FlagInvalidReadings(recording::Recording& recording);

}  // namespace abbe::diagnosis
