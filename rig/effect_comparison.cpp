#include "rig/effect_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "failure/failure.h"

namespace abbe::rig {
namespace {

using nlohmann::ordered_json;

constexpr double kFullTurn = 2.0 * std::numbers::pi;

std::string NameOf(const ordered_json& effect) {
  return effect.at("cause").get<std::string>() + ":" + effect.at("object").get<std::string>();
}

EffectComparison Compared(const ordered_json& effect, const ordered_json& findings) {
  EffectComparison compared{NameOf(effect), 0.0, {}};
  const auto finding =
      std::find_if(findings.begin(), findings.end(),
                   [&](const ordered_json& each) { return NameOf(each) == compared.name; });
  if (finding == findings.end()) return compared;
  compared.probability = finding->at("probability");
  if (!finding->contains("parameters")) return compared;
  for (const ordered_json& each : finding->at("parameters")) {
    const std::string key = each.at("name");
    const ordered_json& truth = effect.at("parameters");
    if (!truth.contains(key) || !truth.at(key).is_number()) continue;
    KeyComparison at{key, truth.at(key), each.at("value"), each.at("u95")};
    if (key == "phase_rad") at.found += kFullTurn * std::round((at.truth - at.found) / kFullTurn);
    compared.keys.push_back(std::move(at));
  }
  return compared;
}

}  // namespace

FindingsComparison CompareFindings(const ordered_json& truth, const ordered_json& diagnosis,
                                   const std::string& name) {
  FindingsComparison comparison;
  try {
    const ordered_json& findings = diagnosis.at("findings");
    for (const ordered_json& effect : truth.at("hidden")) {
      comparison.hidden.push_back(Compared(effect, findings));
    }
    for (const ordered_json& finding : findings) {
      const std::string named = NameOf(finding);
      const bool there = std::any_of(comparison.hidden.begin(), comparison.hidden.end(),
                                     [&](const auto& effect) { return effect.name == named; });
      if (!there) comparison.wrong.push_back(named);
    }
  } catch (const ordered_json::exception& error) {
    throw InputError(
        fmt::format("{}: is not a diagnosis, or the truth is not one of the rig: {}; give what "
                    "--truth wrote first, then the JSON of abbe diagnose",
                    name, error.what()));
  }
  return comparison;
}

}  // namespace abbe::rig
