// The readers of the kinds of results, and what they have in common. For use within history/.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "history/figures_of_result.h"

namespace abbe::history {

using Json = nlohmann::ordered_json;

void ReadSweep(const Json& result, Extract& extract);        // reduce, kind sweep
void ReadSquareness(const Json& result, Extract& extract);   // reduce, kind squareness
void ReadPositioning(const Json& result, Extract& extract);  // reduce, kind reference
void ReadCircle(const Json& result, Extract& extract);
void ReadPath(const Json& result, Extract& extract);
void ReadMap(const Json& result, Extract& extract);  // fuse and plate
void ReadCalibration(const Json& result, Extract& extract);
void ReadDiagnosis(const Json& result, Extract& extract);

// Nothing for a result that is no sweep.
std::optional<Stations> StationsOf(const Json& result);

inline constexpr double kToMicro = 1e6;  // m -> um, rad -> urad
inline constexpr double kToMillimetre = 1e3;

// "um" or "urad" for "m" or "rad".
inline std::string ShownUnit(std::string_view si) { return si == "m" ? "um" : "urad"; }

// A number at a key, or nothing where it is absent or null.
inline std::optional<double> NumberAt(const Json& object, std::string_view key) {
  const auto at = object.find(key);
  if (at == object.end() || !at->is_number()) return std::nullopt;
  return at->get<double>();
}

// An object at a key, or an empty one.
inline const Json& ObjectAt(const Json& object, std::string_view key) {
  static const Json none = Json::object();
  const auto at = object.find(key);
  return at == object.end() || !at->is_structured() ? none : *at;
}

// The text at a key, or an empty one.
inline std::string TextAt(const Json& object, std::string_view key) {
  const auto at = object.find(key);
  return at == object.end() || !at->is_string() ? std::string() : at->get<std::string>();
}

// The list at a key times `scale`. Null, a missing number, becomes NaN.
inline std::vector<double> ListAt(const Json& object, std::string_view key, double scale) {
  std::vector<double> list;
  for (const Json& each : ObjectAt(object, key)) {
    list.push_back(each.is_number() ? scale * each.get<double>()
                                    : std::numeric_limits<double>::quiet_NaN());
  }
  return list;
}

}  // namespace abbe::history
