#include "recording/good_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "settings/unit.h"

namespace abbe::recording {

bool HasGoodRow(const Recording& recording) {
  const auto flags = recording.Find("flags");
  return flags ? std::find(flags->begin(), flags->end(), 0.0) != flags->end()
               : recording.rows() > 0;
}

void RefuseNoGoodRow(const Recording& recording, std::size_t rows) {
  throw InputError(
      fmt::format("{}: all {} rows are flagged; nothing to evaluate", recording.name, rows));
}

std::vector<std::size_t> GoodRows(const Recording& recording) {
  const auto flags = recording.Find("flags").value_or(std::span<const double>{});
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (flags.empty() || flags[row] == 0) rows.push_back(row);
  }
  if (rows.empty()) RefuseNoGoodRow(recording, recording.rows());
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
      throw InputError(fmt::format("{}: row {}: {} is not a number, and the row has no flag",
                                   recording.name, recording.first_row + row + 1, column));
    }
    values.push_back(all[row] * si);
  }
  return values;
}

}  // namespace abbe::recording
