// What a run of the linkage should read on a machine with errors of its own.
//
// The loop of linkage_simulation.h, with the ball where the machine really holds it:
//
//   gap = X_MB p_BT(readings) - (p_MT(commanded) + error(commanded))       error: machine/
//
// Here the commanded position is no reference with an uncertainty of its own: what the machine does
// with a command is what is to be found. What is left is the noise of the encoders and how well the
// ball repeats (linkage.noise.repeatability). The ball stands in the machine's origin when all axes
// are at zero, and beside it by "ball_seat" of the run, [x y z] in M, where it is seated anew for
// each run (linkage.tolerance.seat). While the machine stands, the ball sits in one way: such a run
// has the noise of its encoders only, and the repeatability is part of its seat.
// A run of more than 4096 poses is gathered into cells of a quarter of the correlation length
// (linkage_cells.h) at the parameters that fit 1024 of them; their chi-square is that of the cells.
//
// Errors in variables: the Jacobian is evaluated at noisy angles, which biases the scale by 3 N u^2
// (N poses, u its standard uncertainty). `condense` removes the bias: it turns the angles until x
// closes the gap, and keeps the gap as a constant. Unknowns: those of the linkage and its base,
// then the machine's functions and squareness.
// Frames: M, B, T as LinkageSimulation.
// Units: m, rad. Shapes: rows x, y, z of each pose or cell; columns as said.
// Failure: InputError for a position outside the travels, naming the row, and for a ball that does
// not go where the chain takes it.
// Source: docs/theory-fusion.md, Long runs and Noise in the angles.
// Validity: exact.
#pragma once

#include "machine/volumetric_model.h"
#include "simulation/linkage/linkage_parts.h"
#include "simulation/linkage/linkage_simulation.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

// `reference`: the machine's reference point, m, in M.
SimulatedRun SimulateLinkage(const machine::VolumetricModel& model,
                             const Eigen::Vector3d& reference, const LinkageSimulation& linkage,
                             const LinkageParts& parts);
// The same of a run that is read as a whole.
SimulatedRun SimulateLinkage(const machine::VolumetricModel& model,
                             const Eigen::Vector3d& reference, const LinkageSimulation& linkage,
                             const LinkageRun& run);
// A run at one place.
SimulatedRun SimulateStandingLinkage(const machine::VolumetricModel& model,
                                     const Eigen::Vector3d& reference,
                                     const LinkageSimulation& linkage, const LinkageRun& run);

}  // namespace abbe::simulation
