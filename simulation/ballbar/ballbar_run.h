// A run with a ballbar as the simulation sees it: where the axes were sent, and how far the tool
// ball then was from the centre ball.
//
//   const BallbarRun run = ReadBallbarRun(recording);
//
// Positions of the recording count from the centre ball; header `centre_mm` = [x, y, z] is where
// the axes stand with the tool there. A position that the recording lacks is that of the centre.
// `sd` is u_radius_um of the header, else how far neighbouring readings scatter: third differences
// within a pass, by their median, which neither a circle nor a reversal changes, and at least
// kFinestBallbarNoise: filtered readings scatter by less than what their instrument tells apart. Where no
// times are known they follow from the way and feed_mm_min, passes a second apart; without feed a
// row counts a second. `length_sd` is u_length_um of the header, of the calibrated length; 0: not calibrated.
// A pass begins where an axis may turn, and how it came there is not recorded: its first rows, until
// each axis that moves has gone 20 um, are left out.
// Frames: axis coordinates; `centre` is part of no error.
// Units: m, s. Shapes: one entry per row; rows with a flag are left out.
// Failure: InputError with the recording's name: no centre_mm, a radius that is not above 0, a
// deviation that is not, readings too few or too coarse to show their noise.
// Source: docs/recordings.md, kind ballbar; median absolute deviation: Hampel, J. Am. Stat. Assoc.
// 69 (1974).
// Validity: noise that neighbouring readings share is not seen in their differences.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/points/machine_points.h"

namespace abbe::simulation {

// m: a step of 0.1 um, of the finest ballbars on the market, as a standard deviation.
inline constexpr double kFinestBallbarNoise = 0.03e-6;

struct BallbarRun {
  MachinePoints points;
  Eigen::Vector3d centre;
  Eigen::VectorXd radius, time;
  std::vector<int> pass;
  std::string ballbar;  // `mounting.ballbar` of the header: the same bar in several runs; may be ""
  double sd = 0.0, length_sd = 0.0;
  bool states_noise = false, times_known = false, feed_known = false;

  Eigen::Index rows() const { return points.count(); }
};

// `noise`: m, where it is known of the whole run; 0: not.
BallbarRun ReadBallbarRun(const recording::Recording& recording, double noise = 0.0);

// At most so many rows, evenly from the whole run.
BallbarRun Thinned(const BallbarRun& run, Eigen::Index most);

// With the positions that a recording of one plane lacks: 0, at the centre.
recording::Recording WithAllPositions(recording::Recording recording);

}  // namespace abbe::simulation
