#include "simulation/causes/causes_table.h"

#include <fmt/format.h>

#include "settings/unit.h"
#include "simulation/causes/registry.h"

namespace abbe::simulation {
namespace {

std::string KeysText(const Cause& cause) {
  std::string text;
  for (const CauseKey& key : cause.keys) {
    if (!text.empty()) text += ", ";
    text += fmt::format("`{}`", key.name);
    const std::string unit(settings::UnitOf(key.name).name);
    if (!unit.empty()) text += fmt::format(" ({})", unit);
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
