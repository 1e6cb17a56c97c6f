// Outliers that only a fit shows: readings that stand alone against the simulation.
//
//   const auto strays = StrayReadingsOf(fit);
//   const Campaign rest = campaign.Without(strays);
//
// What its neighbours say of a reading (invalid_readings.h) is little where a motion begins or
// ends, and nothing where each reading is of another place. A fit says it of all. A stray reading is
// kFar standard deviations from the simulation while the readings before and after it are within
// four, and an error of one channel of the instrument accounts for all of it, better by 16 in
// chi-square than one of any other channel, and no worse than one of the place of an axis. An axis
// that does the same where it turns, in more than a tenth of its turns, jumps there: such readings
// stay, as do more than one of fifty of a run. Means of several readings are not examined.
// Units: s since the recording began. Shapes: one entry a channel and run.
// Failure: none.
// Source: the score test of a shift of one row, Rao, Proc. Cambridge Philosophical Society 44 (1948).
// Validity: independent noise of the rows; to first order at the fit.
#pragma once

#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/fit.h"

namespace abbe::diagnosis {

std::vector<StrayReadings> StrayReadingsOf(const Fit& fit);

}  // namespace abbe::diagnosis
