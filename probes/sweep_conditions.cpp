#include "probes/sweep_conditions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "recording/started.h"
#include "settings/unit.h"

namespace abbe::probes {
namespace {

// Over the rows with a number and without a flag; NaN where there are none.
Spread SpreadOf(const recording::Recording& recording, std::span<const double> values) {
  const auto flags = recording.Find("flags");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Spread spread{kInfinity, -kInfinity, 0.0};
  double count = 0.0;
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (std::isnan(values[row]) || (flags && (*flags)[row] != 0.0)) continue;
    spread.min = std::min(spread.min, values[row]);
    spread.max = std::max(spread.max, values[row]);
    spread.mean += values[row];
    count += 1.0;
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (count == 0.0) return {kNone, kNone, kNone};
  spread.mean /= count;
  return spread;
}

}  // namespace

SweepConditions ConditionsOf(const recording::Recording& recording) {
  SweepConditions conditions;
  conditions.started = recording::StartedText(recording);
  conditions.simulated = recording.IsSimulated();
  const auto time = recording.At("time_s");
  if (!time.empty()) conditions.duration = time.back() - time.front();
  if (const auto feed = recording.Find("feed_mm_min")) {
    const double largest = SpreadOf(recording, *feed).max;
    if (!std::isnan(largest)) conditions.feed = largest * settings::UnitOf("feed_mm_min").si;
  }
  for (const recording::Column& column : recording.columns) {
    if (!column.name.starts_with("temp_") || !column.name.ends_with("_c")) continue;
    const Spread spread = SpreadOf(recording, column.values);
    if (!std::isnan(spread.mean)) conditions.temperatures.push_back({column.name, spread});
  }
  return conditions;
}

}  // namespace abbe::probes
