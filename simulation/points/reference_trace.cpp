#include "simulation/points/reference_trace.h"

#include <fmt/format.h>

#include <algorithm>

#include "simulation/trace_columns.h"

namespace abbe::simulation {
namespace {

Eigen::VectorXd NumbersOf(const std::vector<std::size_t>& rows) {
  Eigen::VectorXd numbers(rows.size());
  std::copy(rows.begin(), rows.end(), numbers.begin());
  return numbers;
}

std::string ApproachColumn(Eigen::Index axis) { return fmt::format("approach_{}", "xyz"[axis]); }

}  // namespace

Trace TraceOf(const recording::Recording& recording, const ReferenceRun& run) {
  Trace trace;
  trace.name = run.points.name;
  trace.averages_known = false;
  trace.on_the_way = OnTheWay::kWhileMoving;
  trace.axis = run.tested;
  trace.started = StartedOf(recording);
  trace.time = trace.clock = run.time;
  trace.pass = run.pass;
  trace.direction = run.direction;
  trace.SetAxes(run.points.axes);
  if (run.tested != ' ' && trace.velocity.isZero(0.0)) trace.since_reversal.setConstant(kLongAgo);
  AddSensors(recording, run.points.rows, trace);
  return trace;
}

Trace TraceOf(const recording::Recording& recording, const MachinePoints& points) {
  Trace trace;
  trace.name = points.name;
  trace.averages_known = recording.Kind() != "plate";
  trace.started = StartedOf(recording);
  const auto rows = points.count();
  trace.time = trace.clock =
      recording.Find("time_s") ? ColumnAt(recording, points, "time_s") : NumbersOf(points.rows);
  trace.pass = IntegersAt(recording, "pass", points.rows);
  trace.direction.assign(points.rows.size(), 0);
  trace.axes = points.axes;
  trace.velocity = trace.acceleration = trace.heading = Eigen::Matrix3Xd::Zero(3, rows);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::string column = ApproachColumn(axis);
    if (recording.Find(column)) trace.heading.row(axis) = ColumnAt(recording, points, column);
  }
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, rows, kLongAgo);
  AddSensors(recording, points.rows, trace);
  return trace;
}

void NoteUnknownApproach(const recording::Recording& recording, std::vector<std::string>& notes) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (recording.Find(ApproachColumn(axis))) return;
  }
  notes.push_back(fmt::format(
      "{}: does not state from which side each axis came to its places (columns approach_x, "
      "approach_y, approach_z), so backlash does not show in it",
      recording.name));
}

}  // namespace abbe::simulation
