#include "simulation/planned_run.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

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

// Bits of a multiplicative hash: Knuth, The Art of Computer Programming 3, 6.4.
double MixedSign(std::size_t row, std::size_t channel) {
  std::uint64_t bits = (8 * row + channel + 1) * 0x9E3779B97F4A7C15u;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  return ((bits ^ (bits >> 27)) >> 40) % 2 == 0 ? 1.0 : -1.0;
}

std::vector<double>& ColumnIn(Recording& recording, const std::string& name) {
  const auto found = std::find_if(recording.columns.begin(), recording.columns.end(),
                                  [&](const auto& column) { return column.name == name; });
  if (found != recording.columns.end()) return found->values;
  recording.columns.push_back({name, std::vector<double>(recording.rows(), 0.0)});
  return recording.columns.back().values;
}

}  // namespace abbe::simulation
