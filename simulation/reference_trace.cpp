#include "simulation/reference_trace.h"

#include "simulation/trace_columns.h"

namespace abbe::simulation {

Trace TraceOf(const recording::Recording& recording, const ReferenceRun& run) {
  Trace trace;
  trace.name = run.points.name;
  trace.kind = "reference";
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

}  // namespace abbe::simulation
