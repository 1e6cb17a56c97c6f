// What the header of a sweep planned, and how much of it the recording lacks: a copy that was cut
// off, or a sweep that was stopped, looks like a shorter one.
// Frames: stations along the axis, as the control counts. Units: m in, counts out. Shapes: one entry
// a station. Failure: InputError for a plan that is no list of numbers. Validity: a station
// counts as measured where one lies nearer than half the distance of the planned ones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::probes {

struct PlannedSweep {
  int stations = 0, passes = 0;
  int missing_stations = 0, missing_passes = 0;
};

// `stations` (m) and `passes` are those that were measured. Nothing for a header without a plan.
std::optional<PlannedSweep> PlannedSweepOf(const recording::Recording& recording,
                                           const std::vector<double>& stations, int passes);

// What is missing, in one sentence; nothing if all is there.
std::optional<std::string> MissingNote(const PlannedSweep& planned);

}  // namespace abbe::probes
