// The drawn errors of the rig as JSON, and the deviation of a result from them.
//
// Truth: {"machine", "seed", "axes": {"X": {"stations_m": [], "EXX": [], ... "ECX": []}, ...},
// "scale": {"X": ...}, "squareness": {"A0Z", "B0Z", "C0Y"}, "head": {drawn values}, "hidden": [as
// hidden_effect.h]}. Errors are those of the carriage at the machine's reference point, m and rad,
// at the stations of the sweep (or of 61 equal steps over the travel where the machine file plans
// none).
//
// Comparison: a result is the JSON of a sweep reduction, with "axis", "stations" (m) and "errors":
// {"EYX": {"value": [], "u": []}, ...}. An angle is compared relative to the first station, a
// straightness as the deviation from its own least-squares line over the stations, truth and result
// alike, so that only what a sweep defines is compared. Truth between its stations is interpolated
// linearly. A station that is zero by definition (u = 0 and no error, the first one of an angle) is
// left out of rms_pull and share_inside_2u.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rig/world.h"

namespace abbe::rig {

nlohmann::ordered_json TruthOf(const World& world);

// m or rad.
struct ComponentComparison {
  std::string component;  // "EYX"
  std::size_t stations;
  double rms_error;
  double max_error;        // largest magnitude
  double rms_pull;         // rms of error / u; NaN when a u is missing or not positive
  double share_inside_2u;  // 0 to 1; NaN as above
};

// In the order of the result. InputError naming `name` (for messages) when a key is missing, lists
// differ in length, the axis is not in the truth, or a station lies outside the stations of the
// truth by more than a hundredth of their step.
std::vector<ComponentComparison> Compare(const nlohmann::ordered_json& truth,
                                         const nlohmann::ordered_json& result,
                                         const std::string& name);

}  // namespace abbe::rig
