#include "apps/map_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "map/map_grid.h"

namespace abbe::apps {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using nlohmann::ordered_json;

constexpr Index kGridPoints = 11;      // along each axis
constexpr Index kFunctionPoints = 61;  // of each error function

// To a picometre or picoradian: more would only make the file large.
double Short(double value) { return std::round(value * 1e12) * 1e-12; }

map::GridAxis TravelOf(const map::ErrorMap& map, int axis, Index count) {
  const machine::Travel& travel = map.model().travels()[static_cast<std::size_t>(axis)];
  return {travel.first, travel.last, count};
}

// x runs fastest, then y, then z.
ordered_json GridJson(const map::ErrorMap& map) {
  std::array<map::GridAxis, 3> axes;
  ordered_json json;
  for (int k = 0; k < 3; ++k) {
    axes[static_cast<std::size_t>(k)] = TravelOf(map, k, kGridPoints);
    for (Index i = 0; i < kGridPoints; ++i) {
      json[std::string(1, "xyz"[k])].push_back(Short(axes[static_cast<std::size_t>(k)].At(i)));
    }
  }
  const map::MapGrid places(axes,
                            Eigen::Matrix3Xd::Zero(3, kGridPoints * kGridPoints * kGridPoints), {});
  for (Index i = 0; i < places.size(); ++i) {
    const Vector3d position = places.Position(i);
    const Vector3d error = map.Error(position, map.origin().tool);
    for (int k = 0; k < 3; ++k) json["error"][k].push_back(Short(error[k]));
    if (!map.StatesUncertainty()) continue;
    const Vector3d u = map.StandardUncertainty(position, map.origin().tool);
    for (int k = 0; k < 3; ++k) json["u"][k].push_back(Short(u[k]));
  }
  return json;
}

// `first`: of its coefficients among the parameters of the map.
ordered_json FunctionJson(const map::ErrorMap& map, int axis, int motion, Index first) {
  const machine::ErrorFunction& function = map.model().Function(axis, motion);
  const map::GridAxis places = TravelOf(map, axis, kFunctionPoints);
  const Index count = function.size();
  Eigen::VectorXd gradient(count);
  ordered_json json = {{"unit", motion < 3 ? "m" : "rad"}};
  for (Index i = 0; i < places.count; ++i) {
    json["positions"].push_back(Short(places.At(i)));
    json["value"].push_back(Short(function.Evaluate(places.At(i), nullptr, gradient.data())));
    if (!map.StatesUncertainty()) continue;
    const double variance = gradient.dot(map.cov_pp().block(first, first, count, count) * gradient);
    json["u"].push_back(Short(std::sqrt(std::max(0.0, variance))));
  }
  return json;
}

ordered_json ErrorsJson(const map::ErrorMap& map) {
  ordered_json json;
  Index first = 0;
  for (int error = 0; error < map::kErrors; ++error) {
    const int axis = error / machine::kMotions, motion = error % machine::kMotions;
    ordered_json& one = json[map::ErrorName(error)];
    if (axis < machine::kAxes) {
      one = FunctionJson(map, axis, motion, first);
      first += map.model().Function(axis, motion).size();
    } else {
      one = {{"unit", "rad"}, {"value", Short(map.model().squareness()[motion])}};
      if (map.StatesUncertainty()) one["u"] = Short(std::sqrt(map.cov_pp()(first, first)));
      ++first;
    }
    const auto source = map.origin().sources[static_cast<std::size_t>(error)];
    one["from"] = map::kSourceNames[static_cast<std::size_t>(source)];
  }
  return json;
}

}  // namespace

ordered_json MapJson(const map::ErrorMap& map) {
  ordered_json json;
  for (const double at : map.origin().tool) json["tool"].push_back(at);
  for (const double sign : map::AxisSigns(map.model().chain())) json["signs"].push_back(sign);
  json["temperature_c"] = map.origin().temperature;
  json["grid"] = GridJson(map);
  json["errors"] = ErrorsJson(map);
  return json;
}

}  // namespace abbe::apps
