// A calibration from recordings that were corrected for causes of which not all are certain, or
// beside which something is unexplained (simulation/doubt.h).
//
//   AddDoubt(without, unexplained, runs, settings, report);
//
// The covariance gets the change of the parameters against the calibration `without` those causes
// as one standard uncertainty, and grows until the ball of the runs is as unknown as what is
// unexplained, m rms over the poses and coordinates.
// Units: m, rad. Shapes: the covariance keeps its size and order.
// Failure: InputError where the two have other free parameters.
// Source: own; simulation/doubt.h has the reasons.
// Validity: first order; the change counts as one standard uncertainty, also where it is many.
#pragma once

#include <vector>

#include "fusion/calibrate.h"

namespace abbe::fusion {

// Changes the covariance and the uncertainties of `report`.
void AddDoubt(const CalibrationReport& without, double unexplained,
              const std::vector<simulation::LinkageRun>& runs,
              const relm::LinkageSettings& settings, CalibrationReport& report);

}  // namespace abbe::fusion
