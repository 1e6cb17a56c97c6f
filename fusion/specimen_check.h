// Checks a map with a specimen of known length: its measured length, without and with correction by
// the map.
//
//   for (const SpecimenLength& each : CheckSpecimen(map, recording)) ...
//
// The recording is of kind length (simulation/points/length_simulation.h) that was not used for the
// map.
// Units: m. Shapes: one entry a length.
// Failure: InputError as there.
// Source: Ha and Khanh, "An application of neural network in calibration of coordinate measuring
// machines" (2011), section 6: a specimen of 100 mm measured 100.037 mm before and 100.009 mm after
// compensation.
// Validity: U of the specimen's certificate is not in `u`; compare |after - length| with both.
#pragma once

#include <vector>

#include "map/error_map.h"
#include "recording/recording.h"

namespace abbe::fusion {

struct SpecimenLength {
  std::size_t row;       // of the recording, from 0
  double length;         // calibrated
  double before, after;  // measured, without and with the map
  double u;              // standard uncertainty of `after` that the map brings
};

// One entry a row of the recording.
std::vector<SpecimenLength> CheckSpecimen(const map::ErrorMap& map,
                                          const recording::Recording& recording);

}  // namespace abbe::fusion
