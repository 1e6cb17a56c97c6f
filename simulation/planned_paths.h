// Paths of runs that nobody has recorded yet, as recordings without readings (planned_run.h).
//
//   const PathAbout about{"demo-mill", started, {{"temp_table_c", 20.1}}};
//   const recording::Recording circle = CirclePath({.centre = middle, .radius = 0.02}, about);
//
// Circle: once round in each sense, at constant feed. Gap steps: at some stations of a sweep the
// two other axes step through 0, +45, 0, -45, 0 um, docs/recordings.md. Still: nothing moves,
// samples 0.093 s apart. Lengths: places along an axis, with their uncertainty. Sweep: stands along
// an axis, there and back. Grid: stands at places of a box.
// Frames: positions as the control counts.
// Units: SI; the columns those of a recording. Shapes: one row a position, in the order of time.
// Failure: none here; the kind refuses what it cannot plan.
// Source: docs/recordings.md.
// Validity: feeds are reached at once: the paths have no accelerations at their ends.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "machine/machine.h"
#include "recording/recording.h"

namespace abbe::simulation {

struct PathAbout {
  std::string machine;
  double started = 0.0;                            // s since 1970
  std::map<std::string, double> temperature = {};  // by column
};

// A recording's header: what there is to say, then its table [mounting].
struct HeaderAbout {
  std::string kind, machine;
  double started = 0.0;
  std::string more = {};      // further keys, a line each
  std::string mounting = {};  // keys of the table [mounting]
};
// TOML, as at the head of a recording.
std::string HeaderOf(const HeaderAbout& about);

struct CirclePlan {
  std::string plane = "XY";
  Eigen::Vector3d centre;
  double radius = 0.01;
  double feed = 0.01;                       // m/s
  int rows = 180;                           // in a turn
  std::string mounting = {};                // lines of that table
  std::string kind = "linkage", more = {};  // of the header
};
// Counter-clockwise first.
recording::Recording CirclePath(const CirclePlan& plan, const PathAbout& about);

// `start`: positions of all axes; `stations` of `axis`.
recording::Recording GapStepPath(char axis, const Eigen::Vector3d& start,
                                 const std::vector<double>& stations, const PathAbout& about);

// Along `axis` there and back with stands at equal steps, the other axes at the first ends of their
// travels. `mounting`: lines of that table.
recording::Recording SweepPath(char axis, const std::array<machine::Travel, 3>& travels,
                               const std::string& mounting, const PathAbout& about);

// Stands at the points of a grid over a box about `middle`, line by line, to and fro.
struct GridPlan {
  Eigen::Vector3d middle, size;
  Eigen::Vector3i counts;
  double feed = 0.01;  // m/s
  std::string mounting = {};
};
recording::Recording GridPath(const GridPlan& plan, const PathAbout& about);

// At `at`; `axis` is that of the header.
recording::Recording StillPath(char axis, const Eigen::Vector3d& at, const PathAbout& about);

// Along `axis` over `travel`, the other axes at `middle`.
recording::Recording LengthPath(char axis, const Eigen::Vector3d& middle,
                                const machine::Travel& travel, const PathAbout& about);

// The same path, begun at another instant, s since 1970.
recording::Recording BegunAt(recording::Recording path, double started);

// s, of a recording.
double DurationOf(const recording::Recording& recording);

}  // namespace abbe::simulation
