// A recording of an arm before a reference instrument (simulation/arm/arm_run.h) as a run of the
// diagnosis.
//
//   runs.push_back(MakeArmRun(recording, setup, notes, bad));
//
// Noise of a pose: that of the encoders, of the instrument (ref_u_um or linkage.noise.reference_um)
// and of how the arm repeats (linkage.noise.repeatability_um). Where the instrument stands is found
// from the poses; runs with the same mounting.base in their header share it. Poses far off what the
// arm's geometry makes of all others are left out (arm_baseline.h), told in `bad` and, the worst
// with row and size, in `notes`. What was fitted goes into `setup`, so that a part of the run is
// held against the whole. Units: m, rad, s. Failure: that of ReadLinkageRun and of FitArm.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/campaign.h"

namespace abbe::diagnosis {

DiagnosedRun MakeArmRun(const recording::Recording& recording, Setup& setup,
                        std::vector<std::string>& notes, std::vector<BadData>& bad);

// The simulation of a run of an arm, its noise as large as `baseline` says.
simulation::SimulatedRun SimulatedArm(const simulation::LinkageRun& run,
                                      const ArmBaseline& baseline);

}  // namespace abbe::diagnosis
