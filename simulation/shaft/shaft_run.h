// A turning shaft or wheel under gap sensors as the simulation sees it.
//
//   const ShaftRun run = ReadShaftRun(recording);
//
// Columns gap_1_mm, gap_2_mm ... (up to five; any unit of length) and shaft_deg or shaft_rad, at
// times of their own: a channel that says nothing in a row is nan there (paths/shaft_readings.h).
// Header: sensor_deg = [0, 120, 240], where the sensors stand round the shaft; u_gap_um, the noise
// of a row, where it is known; shaft_sense = 1, or -1 where the shaft's angle grows against the
// count of sensor_deg. Not stated: `sense` 0, and `place` counts as if it were 1. A row is the mean
// of the readings of one sensor in the time in which the shaft turns by kCell on the average; rows
// of one sensor stand together, in time. At an even speed a mean over a cell takes 0.08 % off the
// order 4, less off lower ones.
// Frames: angles as rim_readings.h counts them.
// Units: m, rad, s. Shapes: one entry a row, rows of one sensor together.
// Failure: that of paths/shaft_readings.h; InputError with the recording's name for no or too many
// gap columns, places that are not as many, a sense or noise that is none, less than one turn under
// a sensor.
// Source: docs/shaft.md.
// Validity: an even speed over a cell; a mean over 2 degrees takes 0.02 % off order 2.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/rim_readings.h"

namespace abbe::simulation {

inline constexpr double kCell = 0.034906585039886591;  // rad: 2 degrees

struct ShaftRun {
  std::string name;  // of the recording
  Eigen::VectorXd time;
  RimReadings rim;
  std::vector<int> turn;  // of each row, from 1
  Eigen::VectorXd sd;     // of the rows of each sensor; 0: not known
  int sense = 0;

  Eigen::Index rows() const { return time.size(); }
};

// All sensors that the recording has.
ShaftRun ReadShaftRun(const recording::Recording& recording);

// 1 or -1; turns the places with it.
void SetSense(int sense, ShaftRun& run);

// At most so many rows, evenly from the whole run.
ShaftRun Thinned(const ShaftRun& run, Eigen::Index most);

}  // namespace abbe::simulation
