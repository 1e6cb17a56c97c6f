// Whether the encoders are those that the machine file says: order, sense and counts per turn.
//
//   CheckEncoders(simulation, run);      // throws and names the encoder
//
// Called when a calibration fits badly. It asks the estimator for the pose of the base and the
// offset of each encoder on the nominal chain, under one assumption after the other: as stated; two
// encoders swapped; each encoder with a gain of its own. The one with the smallest gap is told as
// the cause if that is less than a kExplains-th of the stated one's.
// Units: m. Failure: InputError is the finding; returns when no assumption explains the gap.
// Validity: the run must turn the encoder in question by some hundredths of a radian, more than the
// tolerances of the linkage could do.
#pragma once

#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {

inline constexpr double kExplains = 5.0;

void CheckEncoders(const simulation::LinkageSimulation& simulation,
                   const simulation::LinkageRun& run);

}  // namespace abbe::fusion
