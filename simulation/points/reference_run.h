// A run with a reference instrument as the simulation sees it: where the axes were sent, and where
// the instrument found them.
//
//   ReferenceRun run = MeansOfStays(ReadReferenceRun(WithAllAxes(recording, mill.travels)));
//
// `place` is in axis coordinates, from the columns ref_x_mm, ref_y_mm, ref_z_mm; a direction that
// the instrument does not show has `shown` false and place 0. `sd` is the standard deviation of
// each place: the column ref_u_um, else `u_reference_um` of the header, else 0: not stated; it is
// not averaged in a stay. A recording without time_s counts its rows; `timed` is then false, as
// where the header says time = "order". `tested`: the axis of a positioning test, the only one that
// moves, with the direction of the approach to each target in the column `direction`; ' ' in other
// runs.
// Frames: axis coordinates.
// Units: m, s. Shapes: one column or entry per row; rows with a flag are left out.
// Failure: that of simulation/points/machine_points.h; InputError without any ref column, for a
// deviation that is not above 0.
// Source: docs/recordings.md, kind reference.
// Validity: a stay is a sequence of rows of one pass and direction whose commanded position keeps
// within kStayWindow of its first.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "machine/machine.h"
#include "recording/recording.h"
#include "simulation/points/machine_points.h"

namespace abbe::simulation {

struct ReferenceRun {
  MachinePoints points;
  std::array<bool, 3> shown{};
  Eigen::Matrix3Xd place, sd;  // [x y z]
  Eigen::VectorXd time;
  std::vector<int> pass, direction;
  char tested = ' ';
  double u_scale = 0.0;  // relative uncertainty that all places share
  bool timed = true;

  Eigen::Index rows() const { return points.count(); }
};

// Row by row.
ReferenceRun ReadReferenceRun(const recording::Recording& recording);

// A test of one axis says nothing of the others: they stood somewhere, which only moves the lever
// of a turn by a constant. Here each is put where it shows 0, or to the end of its travel next to
// that.
recording::Recording WithAllAxes(recording::Recording recording,
                                 const std::array<machine::Travel, 3>& travels);

// A row in no stay is one of its own.
ReferenceRun MeansOfStays(const ReferenceRun& run);

// At most so many rows, evenly from the whole run.
ReferenceRun Thinned(const ReferenceRun& run, Eigen::Index most);

}  // namespace abbe::simulation
