#include "settings/column_name.h"

#include <array>
#include <utility>

#include "settings/words.h"

namespace abbe::settings {
namespace {

// What stands before and after the unit in the name of a table's column.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kUnitMarks{
    {{" / ", ""}, {"[", "]"}, {"(", ")"}}};

}  // namespace

ColumnName ColumnNameOf(std::string_view name) {
  for (const auto& [open, close] : kUnitMarks) {
    const auto at = name.rfind(open);
    if (at == std::string_view::npos || !name.ends_with(close)) continue;
    const std::size_t first = at + open.size();
    const Unit unit = WrittenUnit(Trimmed(name.substr(first, name.size() - close.size() - first)));
    if (!unit.name.empty()) return {Trimmed(name.substr(0, at)), unit};
  }
  return {StemOf(name), UnitOf(name)};
}

}  // namespace abbe::settings
