// The tool-cap test: how far friction holds the ball back in its magnetic cap, as a function of
// feed and magnetic force.
//
// While the cap moves, friction displaces the ball in it by e against the motion. The displacement
// d of the ball is that of gauges on the cap, or the reference (which measures the ball) minus the
// commanded position of the cap, or the linkage (which measures the ball) minus a reference that
// measures the tool. The moving rows of one force and feed give, by least squares,
//
//   y_stroke = offset_line - e sense         y: mean of d along the line; sense +1 or -1
//
// A stroke is the motion between two pauses or reversals. A line has the strokes over the same way
// in both directions or, if no way is passed in both, the strokes of equal direction. Its offset
// absorbs the set-up and form of the gauges and all errors that are equal in both directions: those
// of the machine and of the calibration of a linkage. Each stroke counts as one reading, because
// its rows share slow errors; u follows from the repeatability of the strokes. Its degrees of
// freedom are the strokes less the lines less 1.
// Units: m, N, m/s. Shapes: one result for each force and feed. Failure: InputError with the
// recording for a gauge whose column is missing, no moving row, or motion in one direction only.
// Source: the study of the magnetic tool cap in the linkage's second paper (8.5 N, 100 mm/min:
// below 2 um). Validity: with a reference instead of gauges, e includes backlash and servo lag of
// the machine; rows slower than half the usual speed (starts, stops) are left out.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "paths/measured_path.h"
#include "recording/recording.h"

namespace abbe::paths {

// A gauge on the cap: a column, and the axis and sense in which its reading grows with the ball's
// displacement. No gauges: the reference columns of the recording.
struct CapGauge {
  char axis;           // 'X', 'Y' or 'Z'
  double sign;         // +1 or -1
  std::string column;  // "probe_d_um"
};

struct CapDisplacement {
  double force = 0.0;         // N; NaN where the recording has no cap_force_n
  double feed = 0.0;          // m/s
  double displacement = 0.0;  // e, m; > 0: against the motion
  double u = 0.0;             // m: standard uncertainty; infinite without degrees of freedom
  double dof = 0.0;           // degrees of freedom of u
  double scatter = 0.0;       // m: rms residual of single rows
  std::size_t rows = 0;
};

// Without `gauges` by the reference columns.
std::vector<CapDisplacement> EvaluateCap(const recording::Recording& recording,
                                         const std::vector<CapGauge>& gauges);
// `ball`: the path of the calibrated linkage in the same recording, whose reference measures the
// tool.
std::vector<CapDisplacement> EvaluateCap(const recording::Recording& recording,
                                         const MeasuredPath& ball);

}  // namespace abbe::paths
