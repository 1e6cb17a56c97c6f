// The objects of a turning shaft (simulation/rim_readings.h), and what its causes have in common.
// Units: m. Shapes: one entry a row.
// Failure: none.
// Source: docs/shaft.md.
// Validity: small against the radius of the rim.
#pragma once

#include <string>
#include <vector>

#include "simulation/causes/cause.h"

namespace abbe::simulation {

// "shaft" and "sensor_1" ..., where one was recorded.
std::vector<Object> ShaftOf(const Scene& scene);
// From sensor_1 on.
std::vector<Object> RimSensorsOf(const Scene& scene);

// All sensors see the rim farther away by `values`, m, one per row, and show what they show of it.
Disturbance OnRim(const Trace& trace, const Eigen::RowVectorXd& values);

}  // namespace abbe::simulation
