#include "simulation/sweep/sweep_trace.h"

#include <algorithm>
#include <utility>

#include "settings/unit.h"
#include "simulation/trace_columns.h"
#include "simulation/trace_motion.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;

// m beyond the end stations, where a sweep turns; what the plan of a sweep says if nothing is said.
double OverrunOf(const recording::Recording& recording) {
  constexpr double kUsual = 0.5;  // mm
  if (recording.Kind() != "sweep") return 0.0;
  return settings::kMillimetre * recording.HeaderNumber("sweep.overrun_mm").value_or(kUsual);
}

}  // namespace

Trace TraceOf(const recording::Recording& recording, const SweepRun& run) {
  Trace trace;
  trace.name = run.name;
  trace.axis = run.axis;
  trace.mounting = run.mounting;
  trace.started = StartedOf(recording);
  trace.time = trace.clock = run.time;
  trace.samples = run.samples;
  trace.duration = run.duration;
  trace.continuous = recording.Kind() == "sweep";
  trace.pass = run.pass;
  trace.direction = run.direction;
  trace.axes.resize(3, run.rows());
  for (Index row = 0; row < run.rows(); ++row) trace.axes.col(row) = run.AxesAt(row);
  trace.velocity = trace.acceleration = trace.heading = Eigen::Matrix3Xd::Zero(3, run.rows());
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, run.rows(), kLongAgo);
  const Index swept = run.axis - 'X';
  trace.heading.row(swept) = ApproachOf(run.direction);
  if (recording.Kind() == "gap-steps") {
    for (Index k = 0; k < 3; ++k) trace.heading.row(k) = HeadingOf(trace.axes.row(k), kAxisBand);
  }
  for (Index k = 0; k < 3; ++k) {
    trace.since_reversal.row(k) = SinceReversal(trace, k, k == swept ? OverrunOf(recording) : 0.0);
  }
  HeadRows head{run.gap, run.gap.rowwise().mean(), {}, run.mounted.head_turned, {}, {}};
  std::ranges::copy(run.mounted.channels, head.row_of.begin());
  trace.head = std::move(head);
  AddSensors(recording, run.first_rows, trace);
  return trace;
}

}  // namespace abbe::simulation
