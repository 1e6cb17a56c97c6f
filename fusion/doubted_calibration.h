// A calibration from recordings that were corrected for causes of which not all are certain, or
// beside which something is unexplained (simulation/doubt.h).
//
//   AddDoubt(without, unexplained, runs, settings, report);
//
// The covariance gets the change of the parameters against the calibration `without` those causes
// as one standard uncertainty, and grows until the ball of the runs is as unknown as what is
// unexplained, m rms over the poses and coordinates.
// Failure: InputError where the two have other free parameters.
#pragma once

#include <vector>

#include "fusion/calibrate.h"

namespace abbe::fusion {

void AddDoubt(const CalibrationReport& without, double unexplained,
              const std::vector<simulation::LinkageRun>& runs,
              const relm::LinkageSettings& settings, CalibrationReport& report);

}  // namespace abbe::fusion
