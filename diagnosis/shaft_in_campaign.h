// A recording of a turning shaft under gap sensors as a run of the diagnosis.
//
//   runs.push_back(MakeShaftRun(recording, setup, notes));
//
// Each run has its own zeros; the shaft, its axis and the sensors are the same in all runs of a
// campaign. Noise: u_gap_um of the header, else how well the run repeats from turn to turn
// (simulation/shaft/shaft_noise.h); the sense of the shaft: shaft_sense, else what the sensors see. Both
// go into `setup`, so that a part of the run is held against the whole; `notes` says what was
// found. Units: m. Failure: that of simulation/shaft/shaft_run.h; InputError where no noise is known.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/campaign.h"

namespace abbe::diagnosis {

DiagnosedRun MakeShaftRun(const recording::Recording& recording, Setup& setup,
                          std::vector<std::string>& notes);

}  // namespace abbe::diagnosis
