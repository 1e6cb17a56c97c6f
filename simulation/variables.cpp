#include "simulation/variables.h"

#include <algorithm>
#include <set>

#include "settings/unit.h"
#include "simulation/causes/shaft.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::RowVectorXd;

namespace {

const std::string kDirectionOf = "direction of ", kReversalOf = "reversal of ",
                  kSpeedOf = "speed of ", kRateOf = "rate of ", kGapOf = "gap of ",
                  kColumn = "column ", kWayOf = "way of ", kWarmingOf = "warming of ",
                  kTimeOfRun = "time of run";

// "x" of "direction of x".
std::string BehindKind(const std::string& variable) {
  return variable.substr(variable.rfind(' ') + 1);
}

// ln(1 + way / kShort): so fine near the reversal.
RowVectorXd LogarithmOf(const RowVectorXd& way) {
  constexpr double kShort = 0.05e-3;  // m
  return (way.array() / kShort).log1p();
}

// The slope of the line through the values less than kReach away, 0 where these tell none.
RowVectorXd RateOf(const RowVectorXd& values, const Eigen::VectorXd& time) {
  constexpr double kReach = 60.0, kLeast = 1.0;  // s
  RowVectorXd rate = RowVectorXd::Zero(values.size());
  Index first = 0, last = 0;
  double n = 0.0, t = 0.0, tt = 0.0, v = 0.0, tv = 0.0;
  const auto add = [&](Index row, double sign) {
    const double at = time[row] - time[0], value = values[row] - values[0];
    n += sign;
    t += sign * at;
    tt += sign * at * at;
    v += sign * value;
    tv += sign * at * value;
  };
  for (Index row = 0; row < values.size(); ++row) {
    for (; last < values.size() && time[last] - time[row] < kReach; ++last) add(last, 1.0);
    for (; time[row] - time[first] > kReach; ++first) add(first, -1.0);
    const double spread = tt - t * t / n;
    if (spread > n * kLeast * kLeast) rate[row] = (tv - t * v / n) / spread;
  }
  return rate;
}

RowVectorXd RowNamed(const std::string& name, const std::vector<std::string>& names,
                     const Eigen::MatrixXd& rows) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return {};
  return rows.row(found - names.begin());
}

RowVectorXd GapIn(const Trace& trace, const Object& probe) {
  if (!trace.head || probe.first() >= trace.head->gap.rows()) return {};
  return trace.head->gap.row(probe.first());
}

std::vector<std::string> OtherColumnsOf(const Scene& scene) {
  std::set<std::string> names;
  for (const Trace* trace : scene.traces) names.insert(trace->others.begin(), trace->others.end());
  std::vector<std::string> columns;
  columns.reserve(names.size());
  for (const std::string& name : names) columns.push_back(kColumn + name);
  return columns;
}

}  // namespace

RowVectorXd FactorOf(const std::string& variable, const Trace& trace) {
  if (!HasFactor(variable)) return {};
  const Object object(BehindKind(variable));
  if (object.kind() == Object::Kind::kPivot) {
    return trace.linkage->heading.row(object.first());
  }
  return trace.heading.row(BehindKind(variable)[0] - 'x');
}

RowVectorXd ValuesOf(const std::string& variable, const Trace& trace) {
  if (variable.starts_with(kColumn)) {
    return RowNamed(variable.substr(kColumn.size()), trace.others, trace.other);
  }
  if (variable == kTimeOfRun) return trace.time.transpose();
  if (variable.starts_with(kWayOf)) return trace.since_reversal.row(BehindKind(variable)[0] - 'x');
  if (variable.starts_with(kWarmingOf)) {
    return RowNamed(BehindKind(variable), trace.sensors, trace.warming);
  }
  if (variable.starts_with(kDirectionOf)) return ValuesOf(BehindKind(variable), trace);
  if (variable.starts_with(kReversalOf)) {
    return LogarithmOf(trace.since_reversal.row(BehindKind(variable)[0] - 'x'));
  }
  if (variable.starts_with(kSpeedOf)) return trace.velocity.row(BehindKind(variable)[0] - 'x');
  if (variable.starts_with(kRateOf)) {
    const RowVectorXd values = ValuesOf(BehindKind(variable), trace);
    return values.size() == 0 ? values : RateOf(values, trace.clock);
  }
  const Object object(BehindKind(variable));
  if (variable.starts_with(kGapOf)) return GapIn(trace, object);
  if (variable == "time") return trace.clock.transpose();
  if (variable == "run") return RowVectorXd::Constant(trace.rows(), trace.number);
  if (variable == "shaft") return trace.rim->shaft;
  if (variable == "feed") return trace.velocity.colwise().norm();
  if (variable.size() == 1) return trace.axes.row(variable[0] - 'x');
  if (variable.size() == 3) {
    const double sign = variable[1] == '+' ? 1.0 : -1.0;
    return trace.axes.row(variable[0] - 'x') + sign * trace.axes.row(variable[2] - 'x');
  }
  if (object.kind() == Object::Kind::kPivot) {
    if (trace.pivots() == 0) return {};
    return trace.linkage->angles.row(object.first());
  }
  return RowNamed(variable, trace.sensors, trace.temperature);
}

bool HasFactor(const std::string& variable) {
  return variable.starts_with(kDirectionOf) || variable.starts_with(kReversalOf);
}

std::string OwnerOf(const std::string& variable) {
  return variable.starts_with(kColumn) || variable.starts_with(kRateOf) ? "" : BehindKind(variable);
}

bool IsSpeed(const std::string& variable) { return variable.starts_with(kSpeedOf); }
bool IsGap(const std::string& variable) { return variable.starts_with(kGapOf); }
std::string GapOf(const std::string& probe) { return kGapOf + probe; }

std::vector<std::string> VariablesOf(const Scene& scene) {
  std::vector<std::string> variables{"time", "run", "x", "y", "z", "feed"};
  for (const char* axis : {"x", "y", "z"}) {
    variables.push_back(kDirectionOf + axis);
    variables.push_back(kReversalOf + axis);
    variables.push_back(kSpeedOf + axis);
  }
  for (const auto& pivot : PivotsOf(scene)) {
    variables.push_back(pivot.name());
    variables.push_back(kDirectionOf + pivot.name());
  }
  for (const std::string& sensor : scene.Sensors()) {
    variables.push_back(sensor);
    variables.push_back(kRateOf + sensor);
  }
  for (const auto& probe : ProbesOf(scene)) variables.push_back(GapOf(probe.name()));
  for (std::string& column : OtherColumnsOf(scene)) variables.push_back(std::move(column));
  return variables;
}

std::vector<std::string> VariablesToLearnFrom(const Scene& scene) {
  std::vector<std::string> variables{"time", kTimeOfRun, "x",   "y",   "z",   "x+y",
                                     "x-y",  "x+z",      "x-z", "y+z", "y-z", "feed"};
  for (const char* axis : {"x", "y", "z"}) {
    variables.push_back(kSpeedOf + axis);
    variables.push_back(kWayOf + axis);
  }
  for (const auto& pivot : PivotsOf(scene)) variables.push_back(pivot.name());
  for (const std::string& sensor : scene.Sensors()) {
    variables.push_back(kWarmingOf + sensor);
    variables.push_back(kRateOf + sensor);
  }
  for (const auto& probe : ProbesOf(scene)) variables.push_back(GapOf(probe.name()));
  for (std::string& column : OtherColumnsOf(scene)) variables.push_back(std::move(column));
  return variables;
}

bool IsVariable(const std::string& name) {
  const auto is_axis = [](std::string_view text) {
    return text.size() == 1 && text[0] >= 'x' && text[0] <= 'z';
  };
  const auto is_behind = [&](const std::string& kind, const auto& rule) {
    return name.starts_with(kind) && name.size() > kind.size() && rule(name.substr(kind.size()));
  };
  const auto is_sensor = [](const std::string& text) { return text.starts_with("temp_"); };
  const auto is_probe = [](const std::string& text) {
    return Object(text).kind() == Object::Kind::kProbe;
  };
  const bool is_sum = name.size() == 3 && (name[1] == '+' || name[1] == '-') &&
                      is_axis(name.substr(0, 1)) && is_axis(name.substr(2));
  return is_axis(name) || is_sum || name == "time" || name == kTimeOfRun || name == "feed" ||
         Object(name).kind() == Object::Kind::kPivot || is_behind(kSpeedOf, is_axis) ||
         is_behind(kWayOf, is_axis) || is_behind(kWarmingOf, is_sensor) ||
         is_behind(kRateOf, is_sensor) || is_behind(kGapOf, is_probe) ||
         is_behind(kColumn, [](const std::string&) { return true; });
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
  for (const auto& shaft : ShaftOf(scene)) variables.push_back(shaft.name());
  for (const auto& pivot : PivotsOf(scene)) variables.push_back(pivot.name());
  return variables;
}

estimation::PrintUnit UnitOf(const std::string& variable) {
  constexpr double kMicrometre = 1e-6, kHour = 3600.0;
  if (variable.starts_with(kColumn)) {
    return {std::string(settings::UnitOf(variable).name), 1.0};
  }
  if (variable.starts_with(kDirectionOf)) return UnitOf(BehindKind(variable));
  if (variable.starts_with(kReversalOf) || variable.find('*') != std::string::npos) {
    return {"", 1.0};
  }
  if (variable == "time" || variable == kTimeOfRun) return {"s", 1.0};
  if (variable.starts_with(kWarmingOf)) return {"K", 1.0};
  if (variable == "run") return {"", 1.0};
  if (variable == "feed" || IsSpeed(variable)) return {"mm/min", settings::kMillimetrePerMinute};
  if (variable == "shaft" || variable.starts_with("pivot_")) return {"rad", 1.0};
  if (variable.starts_with(kRateOf)) return {"K/h", 1.0 / kHour};
  if (IsGap(variable)) return {"um", kMicrometre};
  if (variable.starts_with("temp_")) return {"degC", 1.0};
  return {"mm", settings::kMillimetre};
}

}  // namespace abbe::simulation
