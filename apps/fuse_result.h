// `abbe fuse`: what it found, as data and as tables for people. SI in the data unless the name says
// otherwise; tables end in a newline.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fusion/fuse.h"

namespace abbe::apps {

nlohmann::ordered_json FuseJson(const fusion::FuseReport& report,
                                const std::vector<simulation::SimulatedRun>& runs);
// The scale and, one line each, the runs.
std::string RunsText(const fusion::FuseReport& report,
                     const std::vector<simulation::SimulatedRun>& runs);
std::string DeterminedBy(const fusion::FunctionSeen& function);
std::string FuseTable(const fusion::FuseReport& report,
                      const std::vector<simulation::SimulatedRun>& runs);

}  // namespace abbe::apps
