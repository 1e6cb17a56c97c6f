// Invalid readings: stuck channels and isolated outliers. Their rows get a flag.
//
//   const auto invalid = FlagInvalidReadings(recording);
//
// Stuck: a channel with one value, to the last bit, in at least kLeastStuck rows in which another
// channel of the instrument changes mostly. Outlier: a reading that is farther than kFar times the
// scatter from its prediction: the median of the neighbouring rows of its stay where the axes stand
// (the mean of the others in stays of three and four), the cubic through the next four valid
// readings of the motion, two on either side if possible, where they move. The scatter is 1.4826
// times the median absolute deviation. Where a step of the channel accounts for the moving rows
// around a reading better than that reading alone, it is no outlier. Channels: probe_*_um,
// pivot_*_rad.
// Units: s since the recording began. Rows with a flag are skipped; a recording without time_s is
// not examined.
// Failure: none.
// Source: the median absolute deviation, Hampel, J. American Statistical Association 69 (1974).
// Validity: a channel that stands still because nothing moves is not stuck: another one must
// change.
#pragma once

#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/run_kind.h"

namespace abbe::diagnosis {

inline constexpr std::size_t kLeastStuck = 12;
inline constexpr double kFar = 8.0;

// Sets the flags in `recording`.
std::vector<simulation::InvalidReadings> FlagInvalidReadings(recording::Recording& recording);

// Flags the rows of these `times`, s, as outliers of one channel.
simulation::InvalidReadings FlagOutliers(recording::Recording& recording, const std::string& object,
                                         const std::vector<double>& times);

}  // namespace abbe::diagnosis
