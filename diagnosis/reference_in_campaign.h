// A recording of a reference instrument as a run of the diagnosis.
//
//   runs.push_back(MakeReferenceRun(recording, setup, model, notes));
//
// Positioning tests (ISO 230-2) and any other way of the axes under a grid encoder or a tracker.
// Axes that a test does not record stand still (simulation/points/reference_run.h); a target counts with
// the mean of its readings. Noise: what the recording states, else how well a positioning test
// repeats (simulation/points/reference_noise.h), else [linkage.noise] of the machine file; what the first
// two say goes into `setup`, so that a part of the run is held against the noise of the whole.
// A run without times has its readings a second apart. `notes` says where the noise is from. Units:
// m, s. Failure: that of simulation/points/reference_run.h; InputError where no noise is known.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/campaign.h"

namespace abbe::diagnosis {

DiagnosedRun MakeReferenceRun(const recording::Recording& recording, Setup& setup,
                              const machine::VolumetricModel& model,
                              std::vector<std::string>& notes);

}  // namespace abbe::diagnosis
