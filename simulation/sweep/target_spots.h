// Where on the target the probes of the head look, row by row.
//
//   trace.head->spots = SpotsOnTarget(chain, head, run);
//   trace.head->spots.row(2 * probe);        // along u, m
//   trace.head->spots.row(2 * probe + 1);    // across, m
//
// In coordinates of the face that move with the target when it is shifted, or reversed about the
// middle of what the head passes: the same spot has the same coordinates in all recordings of one
// swept axis. Across: s of a top probe, n of a side probe.
// Frames: the face of the target: u along the sweep, across it s or n.
// Units: m. Shapes: 10 x rows: u and across of each probe.
// Failure: none.
// Source: own.
// Validity: nominal spots: where the probes really sit in the fixture is not counted.
#pragma once

#include <Eigen/Core>

#include "machine/chain.h"
#include "probes/head_settings.h"
#include "simulation/sweep/sweep_run.h"

namespace abbe::simulation {

// Two rows a probe.
Eigen::MatrixXd SpotsOnTarget(const machine::Chain& chain, const probes::HeadSettings& head,
                              const SweepRun& run);

// How the form of a face correlates between two spots, of the square of their distance, m^2, and
// its correlation length, m: a Gaussian, 0 where it is below 1e-17. Far below that, products with
// it would be too small to be normal numbers, with which a processor is ten times slower.
double FormCorrelation(double square, double length);

}  // namespace abbe::simulation
