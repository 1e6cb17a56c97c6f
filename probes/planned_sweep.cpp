#include "probes/planned_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "settings/document.h"

namespace abbe::probes {
namespace {

int NotMeasured(const std::vector<double>& planned, const std::vector<double>& measured) {
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < planned.size(); ++i) {
    step = std::min(step, std::abs(planned[i] - planned[i - 1]));
  }
  return static_cast<int>(std::ranges::count_if(planned, [&](double wanted) {
    return std::ranges::none_of(
        measured, [&](double station) { return std::abs(station - wanted) < 0.5 * step; });
  }));
}

}  // namespace

std::optional<PlannedSweep> PlannedSweepOf(const recording::Recording& recording,
                                           const std::vector<double>& stations, int passes) {
  const auto header = settings::Document::Parse(recording.header, recording.name + ": header");
  const settings::Table sweep = header.Root().Child("sweep");
  const auto planned = sweep.Quantities("stations_mm", 0, std::vector<double>{});
  if (planned.empty()) return std::nullopt;
  PlannedSweep plan;
  plan.stations = static_cast<int>(planned.size());
  plan.missing_stations = NotMeasured(planned, stations);
  plan.passes = static_cast<int>(sweep.Integer("passes", {.fallback = passes}));
  plan.missing_passes = std::max(0, plan.passes - passes);
  return plan;
}

std::optional<std::string> MissingNote(const PlannedSweep& planned) {
  if (planned.missing_stations == 0 && planned.missing_passes == 0) return std::nullopt;
  return fmt::format(
      "the recording lacks {} of {} stations and {} of {} passes that its header planned: it was "
      "cut off or stopped, and its figures are of what is there; copy the whole file, or sweep "
      "again",
      planned.missing_stations, planned.stations, planned.missing_passes, planned.passes);
}

}  // namespace abbe::probes
