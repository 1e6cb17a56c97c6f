// What a ballbar should read: the distance of the tool ball from the centre ball.
//
//   const SimulatedRun run = SimulateBallbar(model, reference, ReadBallbarRun(recording));
//
//   residual_i = ( r_i - l - |p_i - p_0 - c| ) / sd      p of simulation/points/machine_points.h
//
// r is read, p_0 is where the tool is with the axes at the centre, errors and all. Unknowns:
// "ballbar_centre RUN" [x y z], how far the centre ball is from p_0: known to kPlacedInPlane, and to
// kPlacedAcross across the plane of a circle, where h changes the radius by h^2 / 2R and by h / R of
// what the machine errs there, so that circles alone hardly tell it. "ballbar_length BAR" [length],
// what the bar is longer than stated: known to u_length_um of the header where it was calibrated,
// else not at all, so that the scale of the machine is not seen, only how those of its axes differ.
// A bar that the headers name (mounting.ballbar) has one length in all its runs. Then the machine's
// functions and squareness.
// Frames: M. Units: m. Shapes: a row a reading.
// Failure: that of ReadBallbarRun.
// Source: docs/theory-fusion.md; ISO 230-4 for the test.
// Validity: balls without form; the bar knows nothing along its circle or across its plane.
#pragma once

#include "machine/volumetric_model.h"
#include "simulation/ballbar/ballbar_run.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

// m: how well the centre ball is put where it should be. The seats of tool and ball fit each other,
// which places it across; in the plane any value is seen.
inline constexpr double kPlacedInPlane = 1e-3, kPlacedAcross = 50e-6;

// `reference`: the machine's reference point, m, in M.
SimulatedRun SimulateBallbar(const machine::VolumetricModel& model,
                             const Eigen::Vector3d& reference, const BallbarRun& run);

}  // namespace abbe::simulation
