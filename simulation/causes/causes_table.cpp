#include "simulation/causes/causes_table.h"

#include <fmt/format.h>

#include <optional>

#include "settings/unit.h"
#include "simulation/causes/registry.h"

namespace abbe::simulation {
namespace {

// With two digits.
std::string Rounded(double value) {
  return fmt::format("{:g}", std::stod(fmt::format("{:.2g}", value)));
}

// Between which values it is looked for, in its unit: "0.2 to 30"; empty: all that the runs have.
std::string RangeText(const Cause& cause, double unit) {
  if (cause.wave)
    return fmt::format("{:g} to {:g}", cause.wave->least / unit, cause.wave->most / unit);
  const auto shapes = cause.shapes(Scene{});
  if (shapes.empty()) return "";
  const bool few = cause.fixed_shapes && shapes.size() == 2;
  return fmt::format("{} {} {}", Rounded(shapes.front()[0] / unit), few ? "or" : "to",
                     Rounded(shapes.back()[0] / unit));
}

std::string KeysText(const Cause& cause) {
  std::string text;
  const std::optional<std::size_t> shape = cause.KeyOfShape();
  for (std::size_t i = 0; i < cause.keys.size(); ++i) {
    const CauseKey& key = cause.keys[i];
    if (!text.empty()) text += ", ";
    text += fmt::format("`{}`", key.name);
    std::string told(settings::UnitOf(key.name).name);
    const std::string range = i == shape ? RangeText(cause, key.unit) : "";
    if (!range.empty()) told = told.empty() ? range : fmt::format("{} {}", range, told);
    if (!told.empty()) text += fmt::format(" ({})", told);
  }
  return text;
}

}  // namespace

std::string CausesTable() {
  std::string table =
      "| id | what it is | what it shows in the data | what to check | keys |\n"
      "|---|---|---|---|---|\n";
  for (const Cause& cause : Causes()) {
    table += fmt::format("| `{}` | {} | {} | {} | {} |\n", cause.id, cause.words.what,
                         cause.words.shows, cause.words.check, KeysText(cause));
  }
  return table;
}

}  // namespace abbe::simulation
