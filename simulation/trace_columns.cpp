#include "simulation/trace_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace abbe::simulation {

using Eigen::Index;
using Eigen::RowVectorXd;

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

namespace {

// docs/recordings.md
bool IsKnown(std::string_view name) {
  constexpr std::array<std::string_view, 14> kNames{
      "time_s", "x_mm",     "y_mm",      "z_mm",        "pass",  "direction", "feed_mm_min",
      "flags",  "ref_u_um", "length_mm", "u_length_um", "setup", "hole",      "u_plate_um"};
  constexpr std::array<std::string_view, 7> kBegin{"probe_", "pivot_", "ref_", "plate_",
                                                   "shaft_", "gap_",   "temp_"};
  return std::ranges::find(kNames, name) != kNames.end() ||
         std::ranges::any_of(kBegin, [&](auto begin) { return name.starts_with(begin); });
}

RowVectorXd ValuesAt(const recording::Column& column, const std::vector<std::size_t>& rows) {
  RowVectorXd values(static_cast<Index>(rows.size()));
  std::ranges::transform(rows, values.begin(), [&](std::size_t row) { return column.values[row]; });
  return values;
}

void AddRow(const std::string& name, const RowVectorXd& values, std::vector<std::string>& names,
            Eigen::MatrixXd& all) {
  names.push_back(name);
  all.conservativeResize(static_cast<Index>(names.size()), values.size());
  all.bottomRows<1>() = values;
}

}  // namespace

void AddSensors(const recording::Recording& recording, const std::vector<std::size_t>& rows,
                Trace& trace) {
  for (const auto& column : recording.columns) {
    if (column.name.starts_with("temp_")) {
      AddRow(column.name, ValuesAt(column, rows), trace.sensors, trace.temperature);
    } else if (!IsKnown(column.name)) {
      const RowVectorXd values = ValuesAt(column, rows);
      if (values.allFinite()) AddRow(column.name, values, trace.others, trace.other);
    }
  }
}

}  // namespace abbe::simulation
