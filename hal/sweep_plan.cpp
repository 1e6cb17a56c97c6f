#include "hal/sweep_plan.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "settings/unit.h"

namespace abbe::hal {
namespace {

// Windows around two neighbouring stations must be disjoint, with as much room between.
constexpr double kWindowsBetween = 4.0;
// A step divides the length when the remainder is below a rounding of decimal fractions in the
// file.
constexpr double kStepRemainder = 1e-6;
constexpr double kMostStations = 1e5;  // of one axis
constexpr double kMostVisits = 1e6;    // of all passes, there and back

std::vector<double> SteppedStations(const settings::Table& table) {
  const double first = table.Quantity("first_mm");
  const double last = table.Quantity("last_mm");
  const double step = table.Quantity("step_mm", {.above = 0.0});
  if (!(last > first)) {
    throw table.Error("last_mm", "must be greater than first_mm; a sweep goes both ways anyway");
  }
  const double steps = (last - first) / step;
  const double whole = std::round(steps);
  if (std::abs(steps - whole) > kStepRemainder || whole < 1.0 || whole > kMostStations) {
    throw table.Error(
        "step_mm", fmt::format("does not divide the length of {:.6g} mm into whole steps; change "
                               "it or list the stations in stations_mm",
                               (last - first) / settings::kMillimetre));
  }
  const auto count = static_cast<std::size_t>(whole);
  std::vector<double> stations;
  for (std::size_t i = 0; i <= count; ++i) {
    stations.push_back(first + (last - first) * i / whole);
  }
  return stations;
}

std::vector<double> ReadStations(const settings::Table& table) {
  const auto listed = table.Quantities("stations_mm", 0, std::vector<double>{});
  if (!table.Has("stations_mm")) return SteppedStations(table);
  for (const char* key : {"first_mm", "last_mm", "step_mm"}) {
    if (table.Has(key))
      throw table.Error(key, "is given together with stations_mm; keep one of the two");
  }
  if (listed.size() < 2) throw table.Error("stations_mm", "must list at least two stations");
  return listed;
}

}  // namespace

std::vector<Visit> SweepPlan::Visits() const {
  std::vector<Visit> visits;
  visits.reserve(2 * static_cast<std::size_t>(passes) * stations.size());
  for (int pass = 1; pass <= passes; ++pass) {
    for (std::size_t i = 0; i < stations.size(); ++i) visits.push_back({i, +1, pass});
    for (std::size_t i = stations.size(); i-- > 0;) visits.push_back({i, -1, pass});
  }
  return visits;
}

SweepPlan ReadSweepPlan(const settings::Table& sweep, char axis) {
  SweepPlan plan;
  plan.axis = axis;
  plan.passes =
      static_cast<int>(sweep.Integer("passes", {.fallback = 5, .at_least = 1, .at_most = 1000}));
  plan.dwell = sweep.Quantity("dwell_s", {.fallback = 0.5, .above = 0.0});
  plan.settle = sweep.Quantity("settle_s", {.fallback = 0.1, .at_least = 0.0});
  plan.window = sweep.Quantity("window_um", {.fallback = 20.0, .above = 0.0});
  plan.feed = sweep.Quantity("feed_mm_min", {.fallback = 600.0, .above = 0.0});
  plan.overrun = sweep.Quantity("overrun_mm", {.fallback = 0.5, .above = 0.0});
  plan.idle = sweep.Quantity("idle_s", {.fallback = 60.0, .above = 0.0});
  for (const char* name : {"X", "Y", "Z"}) sweep.Child(name);
  sweep.RefuseUnknown();

  const settings::Table table = sweep.Child(std::string(1, axis));
  plan.stations = ReadStations(table);
  table.RefuseUnknown();
  const double least = kWindowsBetween * plan.window;
  for (std::size_t i = 1; i < plan.stations.size(); ++i) {
    if (plan.stations[i] - plan.stations[i - 1] < least) {
      throw table.Error(
          table.Has("step_mm") ? "step_mm" : "stations_mm",
          fmt::format("station {} must lie at least four windows ({:.6g} mm) above the "
                      "one before it",
                      i + 1, least / settings::kMillimetre));
    }
  }
  if (2.0 * plan.passes * plan.stations.size() > kMostVisits) {
    throw sweep.Error("passes",
                      fmt::format("{} over {} stations are more than a sweep takes ({:g} visits); "
                                  "give fewer",
                                  plan.passes, plan.stations.size(), kMostVisits));
  }
  if (plan.overrun < least) {
    throw sweep.Error("overrun_mm", fmt::format("must be at least four windows ({:.6g} mm)",
                                                least / settings::kMillimetre));
  }
  return plan;
}

}  // namespace abbe::hal
