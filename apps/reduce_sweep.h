// The result of the reduction of a sweep (`abbe reduce`, `abbe sweep`) as data and as a table.
//
// docs/sweep.md lists the keys of the data. SI units; numbers that are not finite are null.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "probes/squareness_of_sweeps.h"
#include "probes/sweep_result.h"

namespace abbe::apps {

nlohmann::ordered_json SweepJson(const probes::SweepResult& result);

// The table for people; ends in a newline.
std::string SweepTable(const probes::SweepResult& result);

nlohmann::ordered_json SquarenessJson(const probes::SquarenessResult& result);
std::string SquarenessLine(const probes::SquarenessResult& result);

}  // namespace abbe::apps
