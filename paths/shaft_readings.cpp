#include "paths/shaft_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "settings/unit.h"

namespace abbe::paths {
namespace {

struct Series {
  std::vector<double> time, value;
};

// The finite values of a column in rows without a flag.
Series SeriesOf(const recording::Recording& recording, const std::string& name) {
  const auto time = recording.At("time_s"), column = recording.At(name);
  const auto flags = recording.Find("flags");
  const double si = settings::UnitOf(name).si;
  Series series;
  for (std::size_t row = 0; row < column.size(); ++row) {
    if (!std::isfinite(column[row]) || (flags && (*flags)[row] != 0)) continue;
    series.time.push_back(time[row]);
    series.value.push_back(si * column[row]);
  }
  return series;
}

bool IsAngle(const std::string& name) { return name.ends_with("_deg") || name.ends_with("rad"); }

// Removes the jumps by a whole turn.
void Unwrap(std::vector<double>& angles) {
  for (std::size_t i = 1; i < angles.size(); ++i) {
    angles[i] = angles[i - 1] + std::remainder(angles[i] - angles[i - 1], 2.0 * std::numbers::pi);
  }
}

}  // namespace

ShaftReadings ReadShaft(const recording::Recording& recording, const std::string& angle,
                        const std::string& value) {
  if (!IsAngle(angle)) {
    throw InputError(fmt::format(
        "{}: column {} is no angle by its name; let it end in _deg, _rad, _mrad or _urad",
        recording.name, angle));
  }
  Series angles = SeriesOf(recording, angle);
  if (angles.time.size() < 2) {
    throw InputError(fmt::format("{}: column {} has {} values; an angle between two is needed",
                                 recording.name, angle, angles.time.size()));
  }
  Unwrap(angles.value);
  const Series readings = SeriesOf(recording, value);
  ShaftReadings shaft;
  std::size_t next = 1;
  for (std::size_t i = 0; i < readings.time.size(); ++i) {
    const double time = readings.time[i];
    if (time < angles.time.front() || time > angles.time.back()) continue;
    while (next + 1 < angles.time.size() && angles.time[next] < time) ++next;
    const double step = angles.time[next] - angles.time[next - 1];
    const double share = step > 0.0 ? (time - angles.time[next - 1]) / step : 1.0;
    shaft.time.push_back(time);
    shaft.angle.push_back(std::lerp(angles.value[next - 1], angles.value[next], share));
    shaft.value.push_back(readings.value[i]);
  }
  if (shaft.time.empty()) {
    throw InputError(fmt::format("{}: column {} has no value between the first and the last of {}",
                                 recording.name, value, angle));
  }
  return shaft;
}

}  // namespace abbe::paths
