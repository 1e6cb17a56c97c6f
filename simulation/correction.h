// A recording without what causes add to it: how an extended model reaches everything that works on
// recordings.
//
//   Correction corrected = Correct(recording, causes, origin, instruments);
//   abbe::probes::ReduceSweep(corrected.recording, setup);
//
// Where the stages of a cause go (simulation/disturbance.h):
//   reading   off the gaps of the probes
//   encoder   off the angles of the pivots
//   tool, tip into the angles: to first order those at which the nominal linkage finds the ball
//             where it would be without the cause; likewise a late clock, and a cause that relaxes
//             parameters of the linkage
//   motion    of an axis: to the positions, for there the axes really were. In a sweep only that
//             along the swept axis; what the others do the probes see: off the gaps, as the nominal
//             head sees it
// Rows with a flag stay as they are, and so do recordings that no map is made of (dwell, shaft, a
// linkage before an instrument). What a cause does to a reading is worked out from the reading
// itself: what is neglected is its square (a gain of 1 % beside a swap: 1e-4 of the gap's change).
// Units: `changes` in m and rad. Failure: InputError as for the run itself; a recording of an
// instrument that the machine file lacks.
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

// `origin`: of the model; a recording begins its own where it says nothing.
Correction Correct(const recording::Recording& recording, const std::vector<ModelledCause>& causes,
                   const Origin& origin, const Instruments& instruments);

}  // namespace abbe::simulation
