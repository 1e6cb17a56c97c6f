// The reduction of a sweep with an extended model, which is not sure of all its causes.
//
//   const probes::SweepResult result = ReduceCorrected(recording, setup, causes);
//
// The standard uncertainties of the errors and of their figures contain what simulation/doubt.h
// asks for: each the change of that number by causes that are not certain, and what is unexplained,
// a length as it is, an angle over the shortest arm of the head.
#pragma once

#include "apps/causes_option.h"
#include "probes/sweep_reduction.h"

namespace abbe::apps {

probes::SweepResult ReduceCorrected(const recording::Recording& recording,
                                    const probes::SweepSetup& setup, CauseCorrection& causes);

}  // namespace abbe::apps
