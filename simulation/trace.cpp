#include "simulation/trace.h"

#include <algorithm>

#include "simulation/trace_columns.h"
#include "simulation/trace_motion.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;

constexpr double kPivotBand = 50e-6;  // rad: more than an encoder trembles

RowVectorXd ApproachOf(const std::vector<int>& direction) {
  RowVectorXd heading(static_cast<Index>(direction.size()));
  std::copy(direction.begin(), direction.end(), heading.begin());
  return heading;
}

}  // namespace

RowVectorXd Trace::Behind(int which, double width) const {
  // Between the stations of a sweep, and the targets of a test, any play is taken up.
  const bool follows =
      kind == "linkage" || (kind == "reference" && !velocity.row(which).isZero(0.0));
  if (!follows || width <= 0.0) return -0.5 * heading.row(which);
  return PlayOf(axes.row(which), *this, width);
}

RowVectorXd Trace::PivotBehind(int pivot, double width) const {
  if (width <= 0.0) return -0.5 * turning.row(pivot);
  return ShownPlayOf(
      angles.row(pivot), *this, width,
      aside.size() > 0 ? aside.middleRows(pivot * kWaySteps, kWaySteps) : MatrixXd{});
}

void Trace::SetAxes(const Eigen::Matrix3Xd& path) {
  axes = path;
  const Derivatives motion = DerivativesOf(axes, *this);
  velocity = motion.first;
  acceleration = motion.second;
  heading.resize(3, axes.cols());
  since_reversal.resize(3, axes.cols());
  for (Index i = 0; i < 3; ++i) {
    heading.row(i) = "XYZ"[i] == axis ? ApproachOf(direction) : HeadingOfAxis(*this, i);
    since_reversal.row(i) = SinceReversal(*this, i);
  }
}

void Trace::SetAngles(const MatrixXd& nearer) {
  angles = nearer;
  turning.resize(pivots(), nearer.cols());
  for (Index pivot = 0; pivot < pivots(); ++pivot) {
    turning.row(pivot) = HeadingOf(angles.row(pivot), kPivotBand);
  }
}

namespace {

// m beyond the end stations, where a sweep turns; what the plan of a sweep says if nothing is said.
double OverrunOf(const recording::Recording& recording) {
  constexpr double kUsual = 0.5;
  if (recording.Kind() != "sweep") return 0.0;
  return 1e-3 * recording.HeaderNumber("sweep.overrun_mm").value_or(kUsual);
}

}  // namespace

Trace TraceOf(const recording::Recording& recording, const SweepRun& run) {
  Trace trace;
  trace.name = run.name;
  trace.kind = recording.Kind();
  trace.axis = run.axis;
  trace.mounting = run.mounting;
  trace.head_turned = run.mounted.head_turned;
  trace.started = StartedOf(recording);
  trace.time = trace.clock = run.time;
  trace.samples = run.samples;
  trace.lasting = run.lasting;
  trace.pass = run.pass;
  trace.direction = run.direction;
  trace.axes.resize(3, run.rows());
  for (Index row = 0; row < run.rows(); ++row) trace.axes.col(row) = run.AxesAt(row);
  trace.velocity = trace.acceleration = trace.heading = Eigen::Matrix3Xd::Zero(3, run.rows());
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, run.rows(), kLongAgo);
  const Index swept = run.axis - 'X';
  // The direction of approach, not the last difference: at the end of a pass the axis overruns.
  trace.heading.row(swept) = ApproachOf(run.direction);
  if (trace.kind == "gap-steps") {
    for (Index k = 0; k < 3; ++k) trace.heading.row(k) = HeadingOf(trace.axes.row(k), kAxisBand);
  }
  for (Index k = 0; k < 3; ++k) {
    trace.since_reversal.row(k) = SinceReversal(trace, k, k == swept ? OverrunOf(recording) : 0.0);
  }
  trace.gap = run.gap;
  trace.zero = run.gap.rowwise().mean();
  AddSensors(recording, run.first_rows, trace);
  return trace;
}

Disturbance NoDisturbance(const Trace& trace) { return Disturbance(trace.rows()); }

}  // namespace abbe::simulation
