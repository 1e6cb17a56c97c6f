// A recording corrected for causes: so everything that works on recordings can use an extended
// model.
//
//   Correction corrected = Correct(recording, causes, origin, instruments);  // kinds.h
//   abbe::probes::ReduceSweep(corrected.recording, setup);
//
// The stages of a cause (simulation/disturbance.h) are corrected in:
//   reading   the gaps: subtracted
//   encoder   the angles of the pivots: subtracted
//   tool, tip the angles: to first order those at which the nominal linkage has the ball where it
//             would be without the cause; also for a late clock and for causes that relax parameters
//             of the linkage
//   motion    the positions: those at which the axes really were. In a sweep only along the swept
//             axis; the motions of the other axes are subtracted from the gaps, as the nominal head
//             sees them
// Rows with a flag stay, and so do recordings of kinds that make no map. The effect of a cause is
// computed from the reading itself: its square is neglected (a gain of 1 % with a swap: 1e-4 of the
// gap's change).
// Frames: positions as the control counts; angles of the encoders; gaps of the probes.
// Units: `changes` in m and rad. Shapes: rows and columns of the recording stay.
// Failure: InputError as for the run itself; a recording of an instrument that the machine file
// lacks.
// Source: own; docs/extended-model.md.
// Validity: first order in the causes, as said.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "recording/recording.h"
#include "simulation/extended_model.h"
#include "simulation/instruments.h"

namespace abbe::simulation {

// By how much the numbers of one kind were moved.
struct Change {
  double squares = 0.0, largest = 0.0;
  Eigen::Index count = 0;

  // One number that was moved by so much.
  void Add(double moved);
  double rms() const;
};

struct Changes {
  Change positions, gaps, angles;
};

struct Correction {
  recording::Recording recording;
  Changes changes;
};

}  // namespace abbe::simulation
