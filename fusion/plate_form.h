// The form of a hole plate where its stated uncertainty (the column u_plate_um) is wrong.
//
//   const PlateForm seen = EstimatePlateForm(fit, runs, times);
//   SetPlateForm(seen.times, times, runs);              // in the priors of the holes
//
// A hole has its place in the plate in all set-ups, so these show it. With z the places found over
// their priors of `times` the stated u, and gamma how many of them the readings tell,
//
//   gamma = sum (1 - u^2 / prior^2)      k^2 = (times^2 sum z^2 + n) / (gamma + n),  n = 20
//
// k is 1 where k^2 differs from that by less than four standard deviations. One k for all plates.
// Units: m. Shapes: one k for all plates.
// Failure: none; without holes whose form is uncertain k is 1.
// Source: MacKay, "Bayesian interpolation" (1992), section 4.4, with the prior of
// population_estimate.h for a size.
// Validity: one step to the fixed point; repeat with the new fit.
#pragma once

#include <string_view>
#include <vector>

#include "estimation/result.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

inline constexpr std::string_view kPlateFormKey = "u_plate_um";  // a column of the recording

struct PlateForm {
  double times = 1.0;   // k
  double stated = 0.0;  // m: root mean square; 0: no such hole
  double u_log = 0.0;   // of ln k
};

// `times`: of the priors in `fit`.
PlateForm EstimatePlateForm(const estimation::Result& fit,
                            const std::vector<simulation::SimulatedRun>& runs, double times);
// `before`: of the priors in `runs`.
void SetPlateForm(double times, double before, std::vector<simulation::SimulatedRun>& runs);

}  // namespace abbe::fusion
