#include "simulation/causes/shaft.h"

#include <algorithm>

namespace abbe::simulation {

using Eigen::RowVectorXd;

std::vector<std::string> RimSensorsOf(const Scene& scene) {
  int sensors = 0;
  for (const Trace* trace : scene.traces)
    sensors = std::max(sensors, trace->rim ? trace->rim->sensors : 0);
  std::vector<std::string> names;
  for (int i = 1; i <= sensors; ++i) names.push_back(std::string("sensor_") + std::to_string(i));
  return names;
}

std::vector<std::string> ShaftOf(const Scene& scene) {
  if (RimSensorsOf(scene).empty()) return {};
  return {"shaft"};
}

int RimSensorOf(const std::string& object) { return std::stoi(object.substr(7)) - 1; }

Disturbance OnRim(const Trace& trace, const RowVectorXd& values) {
  Disturbance disturbance = NoDisturbance(trace);
  for (int i = 0; i < trace.rim->sensors; ++i) {
    disturbance.row(kReadingStage + i) = values.cwiseProduct(trace.rim->slope);
  }
  return disturbance;
}

}  // namespace abbe::simulation
