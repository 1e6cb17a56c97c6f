#include "simulation/trace_columns.h"

#include <algorithm>

namespace abbe::simulation {

using Eigen::Index;

Eigen::RowVectorXd ApproachOf(const std::vector<int>& direction) {
  Eigen::RowVectorXd heading(direction.size());
  std::copy(direction.begin(), direction.end(), heading.begin());
  return heading;
}

std::vector<int> IntegersAt(const recording::Recording& recording, const std::string& column,
                            const std::vector<std::size_t>& rows) {
  std::vector<int> integers(rows.size(), 1);
  if (const auto values = recording.Find(column)) {
    std::transform(rows.begin(), rows.end(), integers.begin(),
                   [&](std::size_t row) { return static_cast<int>((*values)[row]); });
  }
  return integers;
}

void AddSensors(const recording::Recording& recording, const std::vector<std::size_t>& rows,
                Trace& trace) {
  for (const auto& column : recording.columns) {
    if (!column.name.starts_with("temp_")) continue;
    trace.sensors.push_back(column.name);
    trace.temperature.conservativeResize(trace.sensors.size(), trace.rows());
    for (Index row = 0; row < trace.rows(); ++row) {
      trace.temperature(trace.temperature.rows() - 1, row) = column.values[rows[row]];
    }
  }
}

}  // namespace abbe::simulation
