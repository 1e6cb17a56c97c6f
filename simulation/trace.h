// What stands in a recording beside the readings of a simulated run: when, where, which way, how
// warm. From this a cause works out what it does to each row.
//
//   const Trace trace = TraceOf(recording, run);         // of a sweep or of a linkage
//   trace.heading(0, row);                               // which way the X axis last moved
//
// Units: m, s, rad, K. Shapes: one column or entry per row of the run; an axis or a pivot that has
// not moved yet has heading 0 and has last reversed `kLongAgo` metres ago. Temperatures are
// differences from the first row of the recording with the earliest start (Origin).
// Failure: InputError with the recording's name for a start that is no ISO 8601 time.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/disturbance.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"
#include "simulation/shaft/rim_readings.h"
#include "simulation/sweep/sweep_run.h"

namespace abbe::simulation {

inline constexpr double kLongAgo = 1.0;
inline constexpr const char* kArm = "arm";  // simulation/arm/arm_run.h

struct Trace {
  std::string name;  // of the recording
  std::string kind;  // "sweep", "dwell", "gap-steps", "linkage", "reference", "length", "plate",
                     // "shaft", kArm
  char axis = ' ';   // the swept one
  double started = 0.0;   // s since 1970; 0: not stated
  Eigen::VectorXd time;   // s since the recording began
  Eigen::VectorXd clock;  // s since the first recording began; like `time` before CountFrom
  // Readings in each row, s from the first to the last of them; empty: a row is a reading.
  Eigen::VectorXd samples, lasting;
  std::vector<int> pass, direction;
  Eigen::Matrix3Xd axes;            // [x y z]
  Eigen::Matrix3Xd velocity;        // m/s; 0 while standing
  Eigen::Matrix3Xd acceleration;    // m/s^2
  Eigen::Matrix3Xd heading;         // +1, -1; 0: not moved yet
  Eigen::Matrix3Xd since_reversal;  // m of the axis
  std::vector<std::string> sensors;
  Eigen::MatrixXd temperature, warming;  // degC and K, sensors x rows

  Eigen::Matrix<double, 5, Eigen::Dynamic> gap;  // as read; of a sweep
  Eigen::Matrix<double, 5, 1> zero;              // gap that counts as no motion

  Eigen::MatrixXd tilt;  // rad: of the face against each probe, as simulated; 5 x rows or empty
  bool head_turned = false;
  Eigen::MatrixXd spots;  // where the probes look at the target: target_spots.h; or empty

  Eigen::MatrixXd angles;     // as read, pivots x rows; of a linkage
  Eigen::MatrixXd turning;    // heading of the pivots
  Eigen::MatrixXd aside;      // of the pivots on their way to rows that stand: trace.cpp
  Eigen::Matrix3Xd ball_way;  // where the cap last moved, in M: a direction; 0: nowhere
  Eigen::MatrixXd link;       // 3 pivots x rows, in B: the direction of the link after each pivot
  std::string mounting;

  RimReadings rim;  // of a turning shaft

  Eigen::Index rows() const { return time.size(); }
  Eigen::Index pivots() const { return angles.rows(); }

  // Where what an axis or a pivot drives through a play of this width stands beside the middle, in
  // widths: from -1/2 (it goes to +) to 1/2. Width 0: a play that is taken up at once.
  Eigen::RowVectorXd Behind(int which, double width) const;
  Eigen::RowVectorXd PivotBehind(int pivot, double width) const;
  // The way of the axes with all that follows from it; after time, pass and direction.
  void SetAxes(const Eigen::Matrix3Xd& path);
  // Angles that are nearer to the truth than those that were read.
  void SetAngles(const Eigen::MatrixXd& nearer);
};

Trace TraceOf(const recording::Recording& recording, const SweepRun& run);
Trace TraceOf(const recording::Recording& recording, const LinkageRun& run,
              const LinkageSimulation& linkage);
// Of an arm: `axes` are where the instrument finds the ball; how the arm went from pose to pose is
// not known.
Trace ArmTraceOf(const recording::Recording& recording, const LinkageRun& run,
                 const LinkageSimulation& linkage);

// s since 1970; 0: not stated.
double StartedOf(const recording::Recording& recording);

// When a campaign began, and how warm it was then.
struct Origin {
  double started = 0.0;  // s since 1970
  std::map<std::string, double> temperature;
};
Origin OriginOf(const std::vector<const Trace*>& traces);

// One clock and one zero of each temperature for the runs of a campaign.
void CountFrom(const Origin& origin, Trace& trace);

Disturbance NoDisturbance(const Trace& trace);

// Which way something last moved: +1, -1 from the row on in which it has come back by more than
// `band`; the rows before the first motion have its sign.
Eigen::RowVectorXd HeadingOf(const Eigen::RowVectorXd& position, double band);

}  // namespace abbe::simulation
