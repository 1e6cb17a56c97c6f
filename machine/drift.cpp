#include "machine/drift.h"

#include <algorithm>
#include <array>
#include <utility>

namespace abbe::machine {

Population ReadSizes(const settings::Table& table, const Population& fallback) {
  const auto size = [&](std::string_view key, double usual) {
    return table.Quantity(key, {.fallback = usual, .at_least = 0.0});
  };
  return {.positioning = size("positioning_um", fallback.positioning),
          .straightness = size("straightness_um", fallback.straightness),
          .roll = size("roll_urad", fallback.roll),
          .pitch = size("pitch_urad", fallback.pitch),
          .yaw = size("yaw_urad", fallback.yaw),
          .squareness = size("squareness_urad", fallback.squareness),
          .scale = size("scale_ppm", fallback.scale),
          .smoothness = 0.0};
}

Drift ReadDrift(const settings::Table& root) {
  const settings::Table table = root.Child("drift");
  Drift drift;
  const settings::Table sensors = table.Child("temperature");
  for (const settings::Table& sensor : sensors.Named()) {
    SensorDrift each{.sensor = sensor.key(), .lag = {}, .by_kelvin = {}};
    const double lag = sensor.Quantity("lag_s", {.fallback = 0.0, .at_least = 0.0});
    if (sensor.Has("lag_s")) each.lag = lag;
    each.by_kelvin = ReadSizes(sensor, {.positioning = 0.2,
                                        .straightness = 0.1,
                                        .roll = 2.0,
                                        .pitch = 2.0,
                                        .yaw = 2.0,
                                        .squareness = 3.0,
                                        .scale = 12.0,
                                        .smoothness = 0.0});
    sensor.RefuseUnknown();
    drift.sensors.push_back(std::move(each));
  }
  Population walk = ReadSizes(table, {});
  walk.smoothness = table.Quantity("smoothness_mm", {.fallback = 15.0, .above = 0.0});
  table.RefuseUnknown();
  const std::array keys{"positioning_um", "straightness_um", "roll_urad", "pitch_urad",
                        "yaw_urad",       "squareness_urad", "scale_ppm"};
  const bool stated =
      std::any_of(keys.begin(), keys.end(), [&](const char* key) { return table.Has(key); });
  if (stated) drift.walk = walk;
  return drift;
}

}  // namespace abbe::machine
