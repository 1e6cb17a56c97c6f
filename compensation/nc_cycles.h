// The moves of the canned cycles of an NC program.
//
//   G81   drill             rapid over the hole, to R; feed to the bottom; rapid out
//   G82   drill, dwell      the same with a dwell at the bottom
//   G73   break chips       pecks of Q with a rapid of 0.010 in back; G83: back out each time
//   G85   bore              feed in and out;  G89: with a dwell at the bottom
//   G86   bore              as G82 with the spindle stopped at the bottom, started above
//
// Out is to R with G99, to where the first cycle of a row began with G98 if that is above R.
// Frames: program coordinates. Shapes: positions X, Y, Z. Units: those of the program, throughout.
// Failure: InputError with the line for R below the bottom, Q that is not above 0, more than
// kMostLines moves. Source: RS 274/NGC (NIST IR 6556), 3.5.16; LinuxCNC 2.9 (0.010 in). Validity:
// G74 and G84 tap: their feed is geared to the spindle; G76, G87 and G88 depend on the control.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace abbe::compensation {

struct NcCycle {
  int code = 81;
  int plane = 17;
  bool retracts_to_r = false;
  std::vector<Eigen::Vector2d> holes;  // in the plane
  double initial = 0.0;                // where the first cycle of a row began, along the normal
  double r = 0.0, bottom = 0.0, peck = 0.0, dwell = 0.0;
  double gap = 0.254;  // before the bottom of the hole after a peck
};

enum class NcStep { kRapid, kFeed, kDwell, kSpindleStop, kSpindleStart };

struct NcCycleStep {
  NcStep step;
  Eigen::Vector3d to;  // of kRapid and kFeed
};

// Whether a G word, ten times its code, is a cycle of this file.
bool IsCycle(int code_times_10);

// The moves of a cycle that begins at `from`.
std::vector<NcCycleStep> StepsOf(const NcCycle& cycle, const Eigen::Vector3d& from,
                                 std::size_t line_number);

}  // namespace abbe::compensation
