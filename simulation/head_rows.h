// What the head of probes read in the rows of a run: the part of a trace that sweeps have.
// Frames: gaps and tilts as the probes see them; spots on the face.
// Units: m, rad. Shapes: one column for each row of the run, one row for each probe.
// Failure: none; sweep_trace.h fills it in.
// Source: docs/theory-head.md.
// Validity: tilts are those of the simulation, not measured.
#pragma once

#include <Eigen/Core>
#include <array>

namespace abbe::simulation {

struct HeadRows {
  Eigen::Matrix<double, 5, Eigen::Dynamic> gap;  // m, as read
  Eigen::Matrix<double, 5, 1> zero;              // m: the gap that counts as no motion
  Eigen::MatrixXd tilt;  // rad: of the face against each probe, as simulated; 5 x rows or empty
  bool turned = false;   // the head, by half a turn
  std::array<Eigen::Index, 5> row_of{0, 1, 2, 3, 4};  // each channel, where cables were swapped
  Eigen::MatrixXd spots;  // where the probes look at the target: target_spots.h; or empty
};

}  // namespace abbe::simulation
