// The tool-cap test: by how much friction drags the ball in its magnetic cap against the motion, as
// a function of feed and magnetic force.
//
// While the cap moves with velocity v, friction holds the ball back: it is displaced from its place
// in the cap by e against the motion. Gauges on the cap, a reference that sees the ball beside the
// commanded position of the cap, or the linkage, which sees the ball, beside a reference that sees
// the tool, read a displacement d along their axes; all moving rows of one force and feed give, by
// least squares,
//
//   y_stroke = offset_line - e sense         y: mean of d along the line; sense +1 or -1
//
// A stroke is the way between two pauses or turns; a line is what strokes to and fro have in
// common: the same way, or, where none is passed both ways, the same direction. So set-up and form
// of the gauges (offsets) fall out, and what errs alike to and fro on one way: the machine, the
// calibration of a linkage. Each stroke counts as one reading, however many rows it has, for within
// it rows share what changes slowly; u comes from how well strokes repeat, with strokes - lines - 1
// degrees of freedom.
// Units: m, N, m/s. Shapes: one result for each force and feed. Failure: InputError
// with the recording for a gauge whose column is missing, no moving row, or motion in one direction
// alone. Source: the study of the magnetic tool cap in the linkage's second paper (8.5 N, 100
// mm/min: below 2 um). Validity: with a reference instead of gauges, backlash and servo lag of the
// machine are part of e; rows slower than half the usual speed (starts, stops) are left out.
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
  double scatter = 0.0;       // m: rms of what is left of single rows
  std::size_t rows = 0;
};

std::vector<CapDisplacement> EvaluateCap(const recording::Recording& recording,
                                         const std::vector<CapGauge>& gauges);
// `ball`: the path of the calibrated linkage in the same recording, whose reference sees the tool.
std::vector<CapDisplacement> EvaluateCap(const recording::Recording& recording,
                                         const MeasuredPath& ball);

}  // namespace abbe::paths
