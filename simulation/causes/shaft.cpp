#include "simulation/causes/shaft.h"

#include <algorithm>

namespace abbe::simulation {

using Eigen::RowVectorXd;

std::vector<Object> RimSensorsOf(const Scene& scene) {
  int sensors = 0;
  for (const Trace* trace : scene.traces)
    sensors = std::max(sensors, trace->rim ? trace->rim->sensors : 0);
  std::vector<Object> names;
  for (int i = 1; i <= sensors; ++i) names.emplace_back("sensor_" + std::to_string(i));
  return names;
}

std::vector<Object> ShaftOf(const Scene& scene) {
  if (RimSensorsOf(scene).empty()) return {};
  return {"shaft"};
}

Disturbance OnRim(const Trace& trace, const RowVectorXd& values) {
  Disturbance disturbance = NoDisturbance(trace);
  for (int i = 0; i < trace.rim->sensors; ++i) {
    disturbance.row(kReadingStage + i) = values.cwiseProduct(trace.rim->slope);
  }
  return disturbance;
}

}  // namespace abbe::simulation
