// The channels of the rig, by their names: "x_mm", "probe_a_um", "temp_NAME_c", and the state of
// its controller's program: "pass", "direction", "feed_mm_min".
#pragma once

#include <optional>
#include <string_view>

#include "rig/rig_settings.h"
#include "settings/unit.h"

namespace abbe::rig {

struct RigChannel {
  enum class Quantity { kPosition, kGap, kTemperature, kPass, kDirection, kFeed };
  Quantity quantity;
  int index;    // of the axis or the probe, else 0
  double unit;  // SI value of the unit in the name
};

// Empty when the rig has no such channel.
inline std::optional<RigChannel> ParseChannel(std::string_view name) {
  using Quantity = RigChannel::Quantity;
  const double unit = settings::UnitOf(name).si;
  if (name == "pass") return RigChannel{Quantity::kPass, 0, unit};
  if (name == "direction") return RigChannel{Quantity::kDirection, 0, unit};
  if (name == "feed_mm_min") return RigChannel{Quantity::kFeed, 0, unit};
  if (name.ends_with("_c")) {
    if (name.starts_with("temp_")) return RigChannel{Quantity::kTemperature, 0, unit};
    return std::nullopt;
  }
  const std::string_view stem = name.substr(0, name.rfind('_'));
  if (stem.size() == name.size() || settings::UnitOf(name).name.empty()) return std::nullopt;
  if (stem.size() == 1 && stem[0] >= 'x' && stem[0] <= 'z') {
    return RigChannel{Quantity::kPosition, stem[0] - 'x', unit};
  }
  const int probe = stem.size() == 7 && stem.starts_with("probe_") ? stem[6] - 'a' : -1;
  if (probe < 0 || probe >= kProbes) return std::nullopt;
  return RigChannel{Quantity::kGap, probe, unit};
}

}  // namespace abbe::rig
