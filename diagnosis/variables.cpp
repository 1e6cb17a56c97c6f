#include "diagnosis/variables.h"

#include <algorithm>

#include "settings/unit.h"
#include "simulation/causes/shaft.h"

namespace abbe::diagnosis {

using Eigen::RowVectorXd;
using simulation::Scene;
using simulation::Trace;

namespace {

const std::string kDirectionOf = "direction of ", kReversalOf = "reversal of ";

// "x" of "direction of x".
std::string BehindKind(const std::string& variable) {
  return variable.substr(variable.rfind(' ') + 1);
}

bool IsDirected(const std::string& variable) {
  return variable.starts_with(kDirectionOf) || variable.starts_with(kReversalOf);
}

// ln(1 + way / kShort): so fine near the reversal.
RowVectorXd LogarithmOf(const RowVectorXd& way) {
  constexpr double kShort = 0.05e-3;  // m
  return (way.array() / kShort).log1p();
}

}  // namespace

RowVectorXd FactorOf(const std::string& variable, const Trace& trace) {
  if (!IsDirected(variable)) return {};
  const simulation::Object object(BehindKind(variable));
  if (object.kind() == simulation::Object::Kind::kPivot) {
    return trace.linkage->heading.row(object.first());
  }
  return trace.heading.row(BehindKind(variable)[0] - 'x');
}

RowVectorXd ValuesOf(const std::string& variable, const Trace& trace) {
  if (variable.starts_with(kDirectionOf)) return ValuesOf(BehindKind(variable), trace);
  if (variable.starts_with(kReversalOf)) {
    return LogarithmOf(trace.since_reversal.row(BehindKind(variable)[0] - 'x'));
  }
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
  for (const char* axis : {"x", "y", "z"}) {
    variables.push_back(kDirectionOf + axis);
    variables.push_back(kReversalOf + axis);
  }
  for (const auto& pivot : simulation::PivotsOf(scene)) {
    variables.push_back(pivot.name());
    variables.push_back(kDirectionOf + pivot.name());
  }
  for (const std::string& sensor : scene.Sensors()) variables.push_back(sensor);
  return variables;
}

std::vector<std::string> ProductsOf(const Scene& scene) {
  std::vector<std::string> products{"x*y", "x*z", "y*z"};
  std::vector<std::string> changing{"time"};
  for (const std::string& sensor : scene.Sensors()) changing.push_back(sensor);
  for (const std::string& each : changing) {
    for (const char* axis : {"*x", "*y", "*z"}) products.push_back(each + axis);
  }
  return products;
}

std::vector<std::string> PeriodicVariablesOf(const Scene& scene) {
  std::vector<std::string> variables{"time", "x",   "y",   "z",   "x+y",
                                     "x-y",  "x+z", "x-z", "y+z", "y-z"};
  for (const auto& shaft : simulation::ShaftOf(scene)) variables.push_back(shaft.name());
  for (const auto& pivot : simulation::PivotsOf(scene)) variables.push_back(pivot.name());
  return variables;
}

estimation::PrintUnit UnitOf(const std::string& variable) {
  if (variable.starts_with(kDirectionOf)) return UnitOf(BehindKind(variable));
  if (variable.starts_with(kReversalOf) || variable.find('*') != std::string::npos) {
    return {"", 1.0};
  }
  if (variable == "time") return {"s", 1.0};
  if (variable == "feed") return {"mm/min", settings::kMillimetrePerMinute};
  if (variable == "shaft" || variable.starts_with("pivot_")) return {"rad", 1.0};
  if (variable.starts_with("temp_")) return {"degC", 1.0};
  return {"mm", settings::kMillimetre};
}

}  // namespace abbe::diagnosis
