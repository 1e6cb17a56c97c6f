#include "recording/good_rows.h"

#include <fmt/format.h>

#include <cmath>

#include "settings/unit.h"

namespace abbe::recording {

std::vector<std::size_t> GoodRows(const Recording& recording) {
  const auto flags = recording.Find("flags").value_or(std::span<const double>{});
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (flags.empty() || flags[row] == 0) rows.push_back(row);
  }
  if (rows.empty()) {
    throw InputError(fmt::format("{}: none of the {} rows is without a flag; nothing to evaluate",
                                 recording.name, recording.rows()));
  }
  return rows;
}

std::vector<double> ValuesOf(const Recording& recording, const std::string& column,
                             const std::vector<std::size_t>& rows) {
  const std::span<const double> all = recording.At(column);
  const double si = settings::UnitOf(column).si;
  std::vector<double> values;
  values.reserve(rows.size());
  for (const std::size_t row : rows) {
    if (!std::isfinite(all[row])) {
      throw InputError(fmt::format("{}: row {}: {} is no number and has no flag", recording.name,
                                   row + 1, column));
    }
    values.push_back(all[row] * si);
  }
  return values;
}

}  // namespace abbe::recording
