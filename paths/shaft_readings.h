// Readings of a probe against the angle of a shaft, from channels with times of their own.
//
//   const ShaftReadings readings = ReadShaft(recording, "shaft_deg", "gap_1_mm");
//
// The columns may be nan in rows where their channel has no value. The angle at a reading is
// interpolated in time between the two angles around it; readings before the first and after the
// last angle are left out, and so are rows with a flag.
// Units: s, rad, and the value in SI by the end of its column's name. Shapes: lists of one length.
// Failure: InputError with the recording's name for a missing column, an angle column whose name
// does not end in a unit of angle, fewer than two angles, or no reading between them. Validity:
// less than half a turn between two angles; the angle may wrap.
#pragma once

#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::paths {

struct ShaftReadings {
  std::vector<double> time, angle, value;
};

ShaftReadings ReadShaft(const recording::Recording& recording, const std::string& angle,
                        const std::string& value);

}  // namespace abbe::paths
