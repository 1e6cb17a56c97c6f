#include "diagnosis/variables.h"

#include <algorithm>

#include "settings/unit.h"
#include "simulation/causes/shaft.h"

namespace abbe::diagnosis {

using Eigen::RowVectorXd;
using simulation::Scene;
using simulation::Trace;

RowVectorXd ValuesOf(const std::string& variable, const Trace& trace) {
  if (variable == "time") return trace.clock.transpose();
  if (variable == "shaft") return trace.rim->shaft;
  if (variable == "feed") return trace.velocity.colwise().norm();
  if (variable.size() == 1) return trace.axes.row(variable[0] - 'x');
  if (variable.size() == 3) {
    const double sign = variable[1] == '+' ? 1.0 : -1.0;
    return trace.axes.row(variable[0] - 'x') + sign * trace.axes.row(variable[2] - 'x');
  }
  const simulation::Object object(variable);
  if (object.kind() == simulation::Object::Kind::kPivot) {
    if (trace.pivots() == 0) return {};
    return trace.linkage->angles.row(object.first());
  }
  const auto sensor = std::find(trace.sensors.begin(), trace.sensors.end(), variable);
  if (sensor == trace.sensors.end()) return {};
  return trace.temperature.row(sensor - trace.sensors.begin());
}

std::vector<std::string> VariablesOf(const Scene& scene) {
  std::vector<std::string> variables{"time", "x", "y", "z", "feed"};
  for (const auto& pivot : simulation::PivotsOf(scene)) variables.push_back(pivot.name());
  for (const std::string& sensor : scene.Sensors()) variables.push_back(sensor);
  return variables;
}

std::vector<std::string> PeriodicVariablesOf(const Scene& scene) {
  std::vector<std::string> variables{"time", "x",   "y",   "z",   "x+y",
                                     "x-y",  "x+z", "x-z", "y+z", "y-z"};
  for (const auto& shaft : simulation::ShaftOf(scene)) variables.push_back(shaft.name());
  for (const auto& pivot : simulation::PivotsOf(scene)) variables.push_back(pivot.name());
  return variables;
}

estimation::PrintUnit UnitOf(const std::string& variable) {
  if (variable == "time") return {"s", 1.0};
  if (variable == "feed") return {"mm/min", settings::kMillimetrePerMinute};
  if (variable == "shaft" || variable.starts_with("pivot_")) return {"rad", 1.0};
  if (variable.starts_with("temp_")) return {"degC", 1.0};
  return {"mm", settings::kMillimetre};
}

}  // namespace abbe::diagnosis
