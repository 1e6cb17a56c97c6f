// When the rows of a trace were, and how warm, counted from the beginning of a campaign.
#include <algorithm>

#include "recording/started.h"
#include "simulation/trace.h"

namespace abbe::simulation {

using Eigen::Index;

double StartedOf(const recording::Recording& recording) {
  return recording::StartedAt(recording).value_or(0.0);
}

Origin OriginOf(const std::vector<const Trace*>& traces) {
  Origin origin;
  std::vector<const Trace*> in_time = traces;
  std::stable_sort(in_time.begin(), in_time.end(),
                   [](const Trace* a, const Trace* b) { return a->started < b->started; });
  for (const Trace* trace : in_time) {
    if (origin.started == 0.0) origin.started = trace->started;
  }
  for (const Trace* trace : in_time) {
    for (std::size_t s = 0; s < trace->sensors.size(); ++s) {
      origin.temperature.emplace(trace->sensors[s], trace->temperature(s, 0));
    }
  }
  return origin;
}

void CountFrom(const Origin& origin, Trace& trace) {
  // A run that does not say when it began begins its own clock.
  const double later = trace.started == 0.0 ? 0.0 : trace.started - origin.started;
  trace.clock = trace.time.array() + later;
  trace.warming = trace.temperature;
  for (std::size_t s = 0; s < trace.sensors.size(); ++s) {
    // A sensor that was not there at the start begins with its first value.
    const auto start = origin.temperature.find(trace.sensors[s]);
    trace.warming.row(s).array() -=
        start != origin.temperature.end() ? start->second : trace.temperature(s, 0);
  }
}

}  // namespace abbe::simulation
