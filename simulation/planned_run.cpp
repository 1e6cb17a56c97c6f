#include "simulation/planned_run.h"

#include <algorithm>
#include <cmath>

namespace abbe::simulation {

using recording::Recording;

void FlagPlaces(Recording& path) {
  auto& flags = ColumnIn(path, "flags");
  std::fill(flags.begin(), flags.end(), 0.0);
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
    const auto position = path.At(axis);
    for (std::size_t row = 0; row < flags.size(); ++row) {
      if (!std::isfinite(position[row])) flags[row] = recording::kDeviceError;
    }
  }
}

double AlternatingSign(std::size_t row, std::size_t channel) {
  return (row + channel) % 4 < 2 ? 1.0 : -1.0;
}

std::vector<double>& ColumnIn(Recording& recording, const std::string& name) {
  const auto found = std::find_if(recording.columns.begin(), recording.columns.end(),
                                  [&](const auto& column) { return column.name == name; });
  if (found != recording.columns.end()) return found->values;
  recording.columns.push_back({name, std::vector<double>(recording.rows(), 0.0)});
  return recording.columns.back().values;
}

}  // namespace abbe::simulation
