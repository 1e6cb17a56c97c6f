// Checks the order, the sense and the counts per turn of the encoders against the machine file.
//
//   CheckEncoders(simulation, run);      // throws and names the encoder
//
// Called when a calibration fits badly. It estimates the pose of the base and the offset of each
// encoder on the nominal chain, under one assumption after the other: as stated; two encoders
// swapped; each encoder with a gain of its own. The assumption with the smallest gap is reported if
// its gap is below 1/kExplains of the gap as stated.
// Units: m. Failure: InputError with the cause; returns when no assumption explains the gap.
// Validity: the run must turn the encoder in question by some hundredths of a radian, more than the
// tolerances of the linkage can explain.
#pragma once

#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {

inline constexpr double kExplains = 5.0;

void CheckEncoders(const simulation::LinkageSimulation& simulation,
                   const simulation::LinkageRun& run);

}  // namespace abbe::fusion
