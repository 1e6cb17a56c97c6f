// What a recording says about each row of a simulated run besides its readings: when, where, which
// way, how warm. From this a cause works out what it does to each row.
//
//   const Trace trace = TraceOf(recording, run);         // of the run's kind: sweep_trace.h, ...
//   trace.heading(0, row);                               // which way the X axis last moved
//
// What only one instrument has is a part of its own that other runs lack.
// Frames: axes as the control counts, in M; pivots in B.
// Units: m, s, rad, K. Shapes: one column or entry per row of the run; an axis or a pivot that has
// not moved yet has heading 0 and has last reversed `kLongAgo` metres ago. Temperatures are
// differences from the first row of the recording with the earliest start (Origin).
// Failure: InputError with the recording's name for a start that is no ISO 8601 time.
// Source: own; a backlash element is the play of Krasnosel'skii and Pokrovskii, Systems with
// Hysteresis (1989).
// Validity: what happened between two rows is not known but where linkage_rows.h says so.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/disturbance.h"
#include "simulation/head_rows.h"
#include "simulation/linkage_rows.h"
#include "simulation/rim_readings.h"

namespace abbe::simulation {

inline constexpr double kLongAgo = 1.0;

// The width of a play where the axis is, both in m.
using WidthAt = std::function<double(double)>;

// Whether rows lie on the way of an axis, so that lost motion develops along it; at stations and
// targets it is taken up.
enum class OnTheWay : unsigned char { kNever, kWhileMoving, kAlways };

struct Trace {
  std::string name;  // of the recording
  char axis = ' ';   // the swept one
  std::string mounting;
  double started = 0.0;   // s since 1970; 0: not stated
  Eigen::VectorXd time;   // s since the recording began
  Eigen::VectorXd clock;  // s since the first recording began; like `time` before CountFrom
  // Readings in each row, s from the first to the last of them; empty: a row is a reading.
  Eigen::VectorXd samples, duration;
  bool averages_known = true;  // else a reading may be a mean over an unknown time
  bool continuous = false;     // one instrument read the rows one after the other
  OnTheWay on_the_way = OnTheWay::kNever;
  std::vector<int> pass, direction;
  Eigen::Matrix3Xd axes;            // [x y z]
  Eigen::Matrix3Xd velocity;        // m/s; 0 while standing
  Eigen::Matrix3Xd acceleration;    // m/s^2
  Eigen::Matrix3Xd heading;         // +1, -1; 0: not moved yet
  Eigen::Matrix3Xd since_reversal;  // m of the axis
  std::vector<std::string> sensors;
  Eigen::MatrixXd temperature, warming;  // degC and K, sensors x rows
  // Columns of numbers that are the user's own, as they were recorded; others x rows.
  std::vector<std::string> others;
  Eigen::MatrixXd other;
  int number = 0;  // of the run, in the order in which those of a campaign were made

  std::optional<HeadRows> head;
  std::optional<LinkageRows> linkage;
  std::optional<RimReadings> rim;

  Eigen::Index rows() const { return time.size(); }
  // Tells the runs of a campaign apart, in any part of it: when it began, else its number.
  double identity() const { return started != 0.0 ? started : number; }
  Eigen::Index pivots() const { return linkage ? linkage->angles.rows() : 0; }
  // Whether the tilt of the faces is known.
  bool HasTilt() const { return head && head->tilt.size() > 0; }
  // Where the probes look at the target.
  bool HasSpots() const { return head && head->spots.size() > 0; }

  // Output minus input of a backlash element that an axis or a pivot drives, in units of its width:
  // -1/2 while it moves to +, 1/2 to -. Width 0: backlash that is taken up at once. Of a pivot
  // whose encoder is the output, and lags, the width is below 0.
  Eigen::RowVectorXd BacklashLag(int which, double width) const;
  // The same of an axis whose play is not the same everywhere.
  Eigen::RowVectorXd BacklashLag(int which, const WidthAt& width) const;
  // The same of a pivot.
  Eigen::RowVectorXd PivotBacklashLag(int pivot, double width) const;
  // The way of the axes with all that follows from it; after time, pass and direction.
  void SetAxes(const Eigen::Matrix3Xd& path);
  // Angles of the linkage, and which way they turn.
  void SetAngles(const Eigen::MatrixXd& angles);
};

// s since 1970; 0: not stated.
double StartedOf(const recording::Recording& recording);

// When a campaign began, and how warm it was then.
struct Origin {
  double started = 0.0;  // s since 1970
  std::map<std::string, double> temperature;
};
// The start of the earliest that states one.
Origin OriginOf(const std::vector<const Trace*>& traces);

// One clock and one zero of each temperature for the runs of a campaign.
void CountFrom(const Origin& origin, Trace& trace);

// As many rows, all zero.
Disturbance NoDisturbance(const Trace& trace);

// Which way something last moved: +1, -1 from the row on in which it has come back by more than
// `band`; the rows before the first motion have its sign.
Eigen::RowVectorXd HeadingOf(const Eigen::RowVectorXd& position, double band);

}  // namespace abbe::simulation
