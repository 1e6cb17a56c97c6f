#include "study/hidden/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace abbe::study {

bool Names(const Finding& finding, const rig::HiddenEffect& effect) {
  const auto& candidate = finding.score.candidate;
  return candidate.cause->id == effect.entry->name &&
         candidate.object.name().starts_with(effect.object);
}

std::string NameOf(const rig::HiddenEffect& effect) {
  return fmt::format("{}:{}", effect.entry->name, effect.object);
}

void AddSizes(const Finding& finding, const rig::HiddenEffect& truth, Rate& inside) {
  const auto keys = KeysOf(finding.score);
  for (Eigen::Index i = 0; i < keys.values.size(); ++i) {
    if (!(keys.u[i] > 0.0)) continue;  // counted, not estimated
    const std::string& name = finding.score.candidate.cause->keys[i].name;
    const auto known = truth.values.find(name);
    if (known == truth.values.end()) continue;
    double off = keys.values[i] - truth.At(name);
    if (name == "phase_rad") off = std::remainder(off, 2.0 * std::numbers::pi);
    inside.Add(std::abs(off) <= 2.0 * keys.u[i]);
  }
}

bool LivesIn(const Diagnosis& diagnosis, std::string columns) {
  const bool sensor = columns.ends_with("_c");
  for (const char* unit : {"_mm_min", "_mm", "_rad", "_s"}) {
    if (sensor) break;
    for (auto at = columns.find(unit); at != std::string::npos; at = columns.find(unit)) {
      columns.erase(at, std::string_view(unit).size());
    }
  }
  for (const auto& leftover : diagnosis.leftovers) {
    const auto named = [&](const auto& other) { return other.variable == columns; };
    if (named(leftover) || std::ranges::any_of(leftover.one_of, named)) return true;
  }
  return false;
}

}  // namespace abbe::study
