// An error map as data for the report page: its error on a grid and its 21 errors, each with their
// standard uncertainty, SI; docs/report.md has the keys.
#pragma once

#include <nlohmann/json.hpp>

#include "map/error_map.h"

namespace abbe::apps {

// For the tool point of the measurement. A map without uncertainty has no "u".
nlohmann::ordered_json MapJson(const map::ErrorMap& map);

}  // namespace abbe::apps
