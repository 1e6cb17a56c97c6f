// Columns of a recording in the rows of a run, as a trace takes them. For use within simulation/.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// Whole numbers, such as pass and direction; 1 in a recording without the column.
std::vector<int> IntegersAt(const recording::Recording& recording, const std::string& column,
                            const std::vector<std::size_t>& rows);

// The heading of the axis that a column `direction` is of.
Eigen::RowVectorXd ApproachOf(const std::vector<int>& direction);

// All temperatures of the recording, and the columns that are the user's own where all their values
// are finite, to a trace that has its times.
void AddSensors(const recording::Recording& recording, const std::vector<std::size_t>& rows,
                Trace& trace);

}  // namespace abbe::simulation
