#include "apps/map_json.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "map/map_grid.h"
#include "standards/coverage.h"

namespace abbe::apps {
namespace {

using Eigen::Index;
using nlohmann::ordered_json;

constexpr Index kGridPoints = 11;      // along each axis
constexpr Index kFunctionPoints = 61;  // of each error function

// Rounded to a picometre or picoradian, to keep the file small.
double Short(double value) { return std::round(value * 1e12) * 1e-12; }

// x runs fastest, then y, then z.
ordered_json GridJson(const map::ErrorMap& map) {
  const map::MapGrid grid =
      map::SampleGrid(map, map.origin().tool, {kGridPoints, kGridPoints, kGridPoints});
  ordered_json json;
  for (std::size_t k = 0; k < 3; ++k) {
    const map::GridAxis& axis = grid.axes()[k];
    for (Index i = 0; i < axis.count; ++i) {
      json[std::string(1, "xyz"[k])].push_back(Short(axis.At(i)));
    }
    for (const double error : grid.error().row(k)) json["error"][k].push_back(Short(error));
    if (!map.StatesUncertainty()) continue;
    for (const double u95 : grid.u95().row(k)) {
      json["u"][k].push_back(Short(u95 / standards::kCoverage));
    }
  }
  return json;
}

// A squareness is one number, an error motion a curve over the travel of its axis.
ordered_json ErrorJson(const map::ErrorMap& map, int error) {
  constexpr int kAllMotions = machine::kAxes * machine::kMotions;
  const bool is_curve = error < kAllMotions;
  Eigen::VectorXd positions = Eigen::VectorXd::Zero(1);
  if (is_curve) {
    const auto& travel = map.model().travels()[error / machine::kMotions];
    positions = Eigen::VectorXd::LinSpaced(kFunctionPoints, travel.first, travel.last);
  }
  const auto [value, u] = map.CurveOf(error, positions);
  ordered_json json{{"unit", is_curve && error % machine::kMotions < 3 ? "m" : "rad"}};
  if (!is_curve) {
    json["value"] = Short(value[0]);
    if (map.StatesUncertainty()) json["u"] = Short(u[0]);
    return json;
  }
  for (const double position : positions) json["positions"].push_back(Short(position));
  for (const double each : value) json["value"].push_back(Short(each));
  for (const double each : u) json["u"].push_back(Short(each));
  return json;
}

ordered_json ErrorsJson(const map::ErrorMap& map) {
  ordered_json json;
  for (int error = 0; error < map::kErrors; ++error) {
    ordered_json& one = json[map::ErrorName(error)] = ErrorJson(map, error);
    one["from"] = map.origin().SourceOf(error);
  }
  return json;
}

}  // namespace

ordered_json MapJson(const map::ErrorMap& map) {
  ordered_json json;
  for (const double at : map.origin().tool) json["tool"].push_back(at);
  for (const double sign : map.model().chain().ToolSenses()) json["signs"].push_back(sign);
  json["temperature_c"] = map.origin().temperature;
  // A machine without one of the axes has no volume.
  const auto& travels = map.model().travels();
  if (std::all_of(travels.begin(), travels.end(),
                  [](const machine::Travel& travel) { return travel.last > travel.first; })) {
    json["grid"] = GridJson(map);
  }
  json["errors"] = ErrorsJson(map);
  return json;
}

}  // namespace abbe::apps
