#include "apps/conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "estimation/in_parallel.h"
#include "failure/failure.h"
#include "recording/started.h"

namespace abbe::apps {
namespace {

constexpr double kStep = 1.0;  // s

struct Mean {
  double sum = 0.0, count = 0.0;
};
using Means = std::map<std::string, Mean>;

bool HasSensors(const recording::Recording& head) {
  return std::ranges::any_of(head.columns,
                             [](const auto& column) { return !SensorOf(column.name).empty(); });
}

void AddTo(Means& means, const recording::Recording& block) {
  for (const recording::Column& column : block.columns) {
    const std::string sensor = SensorOf(column.name);
    if (sensor.empty()) continue;
    Mean& mean = means[sensor];
    for (const double value : column.values) {
      if (!std::isfinite(value)) continue;
      mean.sum += value;
      mean.count += 1.0;
    }
  }
}

}  // namespace

std::string SensorOf(const std::string& column) {
  if (!column.starts_with("temp_") || !column.ends_with("_c") || column.size() < 8) return {};
  return column.substr(5, column.size() - 7);
}

double BeganAt(const recording::Recording& head) {
  return recording::StartedAt(head).value_or(0.0);
}

double MustHaveBegan(const recording::Recording& head) {
  const double began = BeganAt(head);
  if (began > 0.0) return began;
  throw InputError(fmt::format(
      "{}: does not say when it was made; add started = \"2026-11-21T09:00:00Z\" to its header",
      head.name));
}

track::Conditions MeanConditions(const std::vector<simulation::RunSource>& sources) {
  track::Conditions conditions;
  std::vector<Means> of_sources(sources.size());
  estimation::InParallel(sources.size(), [&](std::size_t s) {
    if (!HasSensors(sources[s].head)) return;
    sources[s].blocks([&](const recording::Recording& block) { AddTo(of_sources[s], block); });
  });
  Means means;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    conditions.time = std::max(conditions.time, BeganAt(sources[s].head));
    for (const auto& [sensor, mean] : of_sources[s]) {
      means[sensor].sum += mean.sum;
      means[sensor].count += mean.count;
    }
  }
  for (const auto& [sensor, mean] : means) {
    if (mean.count > 0.0) conditions.temperature[sensor] = mean.sum / mean.count;
  }
  return conditions;
}

std::vector<track::Conditions> ConditionsIn(const recording::Recording& recording,
                                            const std::vector<map::Warmth>& sensors,
                                            const std::map<std::string, double>& given) {
  const double began = MustHaveBegan(recording);
  struct Read {
    std::string sensor;
    std::span<const double> values;
  };
  std::vector<Read> columns;
  for (const map::Warmth& each : sensors) {
    const auto column = recording.Find(fmt::format("temp_{}_c", each.sensor));
    if (!column && given.contains(each.sensor)) continue;
    if (!column) {
      throw InputError(fmt::format(
          "{}: has no column temp_{}_c, which the map follows; give --temperature {}=DEGREES",
          recording.name, each.sensor, each.sensor));
    }
    columns.push_back({each.sensor, *column});
  }
  const auto time = recording.KnowsTimes() ? recording.Find("time_s") : std::nullopt;
  std::vector<track::Conditions> rows;
  double before = 0.0;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    const double at = time ? (*time)[row] : 0.0;
    if (row > 0 && at < before) {
      throw InputError(fmt::format("{}: row {}: its clock jumps back by {:.1f} s", recording.name,
                                   row + 1, before - at));
    }
    before = at;
    const bool last = row + 1 == recording.rows();
    if (!rows.empty() && !last && began + at < rows.back().time + kStep) continue;
    track::Conditions conditions{.time = began + at, .temperature = {}};
    for (const map::Warmth& each : sensors) {
      const auto known = given.find(each.sensor);
      if (known != given.end()) conditions.temperature[each.sensor] = known->second;
    }
    for (const Read& each : columns) {
      if (std::isfinite(each.values[row])) conditions.temperature[each.sensor] = each.values[row];
    }
    rows.push_back(std::move(conditions));
  }
  return rows;
}

}  // namespace abbe::apps
