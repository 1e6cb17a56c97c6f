// What a run of calibrated lengths should read: a step gauge, a ball bar, an interferometer line.
//
//   const SimulatedRun run = SimulateLengths(model, reference, recording);
//
// The rows of one pass belong to one thing: in each, the tool point stands at a place of it, and
// length_mm is the calibrated distance of that place from the first row's (0 there):
//
//   residual_i = ( |p_i - p_1| - length_i (1 + scale) ) / u_i        p of
//   simulation/points/machine_points.h
//
// u_length_um is the standard uncertainty of each row. What all lengths of the run have in common,
// a relative error of the instrument or artefact, is stated in the header (`u_scale_ppm`) and
// becomes the unknown "length_scale RUN". Unknowns: the machine's functions and squareness; the
// scale where it is stated.
// Frames: M, as machine_points.h.
// Units: m. Shapes: one row a length.
// Failure: InputError with recording and row: a missing column, a pass of one row, a first length
// that is not 0, a length or an uncertainty that is not above 0, two rows in one place.
// Source: docs/recordings.md, kind length.
// Validity: a pass is a straight thing: only its lengths count, not its direction.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "machine/volumetric_model.h"
#include "recording/recording.h"
#include "simulation/points/machine_points.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

struct Length {
  Eigen::Index from, to;  // points
  double length, u;       // m
};

// In the order of the rows, the first of each pass left out.
std::vector<Length> ReadLengths(const recording::Recording& recording, const MachinePoints& points);

// `reference`: the machine's reference point, m, in M.
SimulatedRun SimulateLengths(const machine::VolumetricModel& model,
                             const Eigen::Vector3d& reference,
                             const recording::Recording& recording);

}  // namespace abbe::simulation
