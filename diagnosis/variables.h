// The recorded variables on which something may depend, by name: "time", "x", "x+y", "pivot_2",
// "shaft", "temp_table_c", "feed".
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "simulation/causes/cause.h"
#include "simulation/trace.h"

namespace abbe::diagnosis {

// In the rows of a run, SI; empty where the run does not have it.
Eigen::RowVectorXd ValuesOf(const std::string& variable, const simulation::Trace& trace);
// s, mm, mm/min, rad, degC
estimation::PrintUnit UnitOf(const std::string& variable);

// Variables of which a channel may be a smooth function.
std::vector<std::string> VariablesOf(const simulation::Scene& scene);
// In what a channel may be a line.
std::vector<std::string> PeriodicVariablesOf(const simulation::Scene& scene);

}  // namespace abbe::diagnosis
