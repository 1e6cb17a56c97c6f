// A run that is only planned, as a recording: a path with the readings that a perfect machine would
// give, so that everything that takes a recording takes it.
//
//   campaign.Add(Planned(path, campaign.setup()));
//
// `path` is any recording of kind sweep, dwell, gap-steps, linkage or length; its positions, times
// and temperatures stay, its readings do not count. The gaps stand in the middle of the range,
// the angles close the nominal linkage; both alternate by the noise of the machine file (+ + - -,
// which has no correlation between neighbours), because the noise of a sweep is taken from its
// readings. Rows with a place get flag 0. Units: those of a recording.
// Failure: InputError for a path without positions, a linkage run without [linkage] in the machine
// file; NumericalError for a pose out of the linkage's reach.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "recording/recording.h"
#include "relm/linkage_settings.h"

namespace abbe::diagnosis {

recording::Recording Planned(recording::Recording path, const Setup& setup);
// With the linkage as it is given: another elbow.
void SetAngles(const Setup& setup, const relm::LinkageSettings& linkage,
               recording::Recording& path);

// The values of a column, made where it is missing.
std::vector<double>& ColumnIn(recording::Recording& recording, const std::string& name);

}  // namespace abbe::diagnosis
