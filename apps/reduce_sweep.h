// `abbe reduce` and `abbe sweep`: what the reduction of a sweep found, as data and as a table.
//
// The keys of the data are listed in docs/sweep.md; SI units, numbers that are not finite are null.
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
