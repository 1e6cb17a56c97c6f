// The result of `abbe fuse` as data and as tables for people. Data in SI unless the key has a unit;
// tables end in a newline.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fusion/fuse.h"

namespace abbe::apps {

nlohmann::ordered_json FuseJson(const fusion::FuseReport& report);
// The scale and, one line each, the runs.
std::string RunsText(const fusion::FuseReport& report);
// The kinds of runs that determine an error function; "prior only" if none does.
std::string DeterminedBy(const fusion::FunctionSeen& function);
std::string FuseTable(const fusion::FuseReport& report);

}  // namespace abbe::apps
