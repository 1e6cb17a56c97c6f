// The recorded variables on which something may depend, by name: "time", "run" (its number), "x",
// "x+y", "pivot_2", "shaft", "feed", "speed of x" (with its sign), "temp_table_c", "rate of
// temp_table_c", "gap of probe_a" and "column humidity" (the user's own); beside them "time of
// run" (since it began), "way of x" (since its reversal) and "warming of temp_table_c" (since the
// campaign began), which only a learned term (learned/ has it) uses. Two have a factor, the
// direction of motion (+1, -1): "direction of x" is that direction, over the position, "reversal of
// x" the same over the logarithm of the way since the reversal.
// Units: SI inside, printed in UnitOf. Shapes: one entry a row of the run.
// Failure: none; an unknown variable is empty.
// Source: docs/diagnose.md.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "simulation/causes/cause.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// In the rows of a run, SI (a column of the user's as it is); empty where the run does not have it.
Eigen::RowVectorXd ValuesOf(const std::string& variable, const Trace& trace);
// The factor of a variable that has one, else empty.
Eigen::RowVectorXd FactorOf(const std::string& variable, const Trace& trace);
// s, mm, mm/min, rad, degC
estimation::PrintUnit UnitOf(const std::string& variable);

bool HasFactor(const std::string& variable);
// The axis, pivot or probe whose own the variable is, in lower case; empty: no one's.
std::string OwnerOf(const std::string& variable);
bool IsSpeed(const std::string& variable);
bool IsGap(const std::string& variable);
std::string GapOf(const std::string& probe);

// Whether there can be a variable of that name.
bool IsVariable(const std::string& name);

// Variables of which a channel may be a smooth function.
std::vector<std::string> VariablesOf(const Scene& scene);
// Two of which a channel may be a function together: "x*y", "time*x", "temp_table_c*x".
std::vector<std::string> ProductsOf(const Scene& scene);
// In what a channel may be a line.
std::vector<std::string> PeriodicVariablesOf(const Scene& scene);

// Those of which a learned term may be an expression: without the number of a run, temperatures as
// they rose since the start.
std::vector<std::string> VariablesToLearnFrom(const Scene& scene);

}  // namespace abbe::simulation
