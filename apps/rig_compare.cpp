#include "apps/rig_compare.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "apps/command.h"
#include "apps/result_file.h"
#include "rig/effect_comparison.h"
#include "rig/truth.h"

namespace abbe::apps {
namespace {

void PrintSweep(const nlohmann::ordered_json& truth, const nlohmann::ordered_json& result,
                const std::string& path) {
  const auto comparison = rig::Compare(truth, result, path);
  fmt::print("{} axis against the truth of seed {} ({})\n", result.value("axis", "?"),
             truth.value("seed", std::uint64_t{0}), path);
  fmt::print("  {:<9} {:>5} {:>11} {:>11} {:>5}  {:>9} {:>10}\n", "component", "n", "rms error",
             "max error", "", "rms e/u", "inside 2u");
  for (const rig::ComponentComparison& row : comparison) {
    const bool angle = row.component.size() > 1 && row.component[1] <= 'C';
    fmt::print("  {:<9} {:>5} {:>11.4f} {:>11.4f} {:<5} {:>9.2f} {:>8.0f} %\n", row.component,
               row.stations, 1e6 * row.rms_error, 1e6 * row.max_error, angle ? "urad" : "um",
               row.rms_pull, 100.0 * row.share_inside_2u);
  }
}

void PrintDiagnosis(const nlohmann::ordered_json& truth, const nlohmann::ordered_json& result,
                    const std::string& path) {
  const rig::FindingsComparison comparison = rig::CompareFindings(truth, result, path);
  fmt::print("diagnosis against the hidden effects of seed {}: {} ({})\n",
             truth.value("seed", std::uint64_t{0}), result.value("verdict", "?"), path);
  if (comparison.hidden.empty()) fmt::print("  nothing is hidden\n");
  for (const rig::EffectComparison& effect : comparison.hidden) {
    fmt::print("  {:<36}{}\n", effect.name,
               effect.probability > 0.0
                   ? fmt::format("found, probability {:.3f}", effect.probability)
                   : "not found");
    for (const rig::KeyComparison& key : effect.keys) {
      fmt::print("    {:<34}{:>10.4g} found, +- {:.2g} (95 %); the truth {:>.4g}\n", key.name,
                 key.found, key.u95, key.truth);
    }
  }
  for (const std::string& name : comparison.wrong) {
    fmt::print("  {:<36}named, but not hidden\n", name);
  }
  const auto rms = [&](const char* chi_square) { return std::sqrt(result.value(chi_square, 0.0)); };
  fmt::print(
      "  measured minus simulated: {:.2f} of the stated noise before, {:.2f} after in all rows",
      rms("chi2_per_row_before"), rms("chi2_per_row_after"));
  if (const auto held = result.find("heldout"); held != result.end()) {
    fmt::print("; {:.2f} before, {:.2f} after in held-out rows", held->value("rms_before", 0.0),
               held->value("rms_after", 0.0));
  }
  fmt::print("\n");
}

}  // namespace

int CompareWithTruth(const std::filesystem::path& truth_path,
                     const std::vector<std::filesystem::path>& results) {
  const auto truth = ReadResult(truth_path);
  for (const auto& path : results) {
    const auto result = ReadResult(path);
    const bool diagnosis = result.value("command", "") == "diagnose";
    (diagnosis ? PrintDiagnosis : PrintSweep)(truth, result, path.string());
  }
  return kDone;
}

}  // namespace abbe::apps
