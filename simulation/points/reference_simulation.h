// What a reference instrument (grid encoder, tracker) should read: the place of the tool point.
//
//   const SimulatedRun run = SimulateReference(model, reference, 0.3e-6, recording);
//
// Columns ref_x_mm, ref_y_mm, ref_z_mm are in axis coordinates: what the axes would show there on a
// perfect machine; any may be absent. The instrument is set up by hand, so its place and its turn
// are unknown; its squareness is taken as right, and its scale s but for u_scale_ppm of the header:
//
//   residual = ref - (place + (1 + s) exp(turn) p(x, y, z)), p of simulation/points/machine_points.h
//
// Unknowns: "reference_place RUN" [x y z], of which nothing is known; "reference_turn RUN" [a b c],
// known to 10 mrad, and none where a line shows its own direction alone (a laser: its turn would
// act by the cosine only, as a scale does, 50 ppm at 10 mrad, and lasers are aligned to 0.1 ppm);
// "reference_scale RUN" where a u_scale_ppm above 0 is stated; the machine's functions and
// squareness. Turn and squareness together stay as well determined as two or three directions of
// the instrument allow. Noise: that of the run; of a recording that states none, `sd` in each
// direction.
// Frames: axis coordinates of a perfect machine; the instrument stands at `place`, turned.
// Units: m, rad. Shapes: rows of the shown directions of each point.
// Failure: that of simulation/points/reference_run.h; InputError for no noise.
// Source: docs/theory-fusion.md.
// Validity: an instrument whose own squareness is right, and a laser along its axis.
#pragma once

#include "machine/volumetric_model.h"
#include "recording/recording.h"
#include "simulation/points/reference_run.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

// `run` states its noise in all directions that it shows.
SimulatedRun SimulateReference(const machine::VolumetricModel& model,
                               const Eigen::Vector3d& reference, const ReferenceRun& run);

// Row by row, as it was recorded.
SimulatedRun SimulateReference(const machine::VolumetricModel& model,
                               const Eigen::Vector3d& reference, double sd,
                               const recording::Recording& recording);

}  // namespace abbe::simulation
