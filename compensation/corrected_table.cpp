#include "compensation/corrected_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "failure/failure.h"
#include "map/words.h"

namespace abbe::compensation {
namespace {

constexpr std::array<std::string_view, 3> kAxes = {"x_mm", "y_mm", "z_mm"};

std::array<std::size_t, 3> ColumnsOf(const std::vector<std::string_view>& names,
                                     const std::string& where) {
  std::array<std::size_t, 3> columns;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto found = std::find(names.begin(), names.end(), kAxes[k]);
    if (found == names.end()) {
      throw InputError(
          fmt::format("{}: there is no column {}; a table of positions has x_mm, y_mm "
                      "and z_mm",
                      where, kAxes[k]));
    }
    columns[k] = found - names.begin();
  }
  return columns;
}

}  // namespace

CorrectedTable CorrectTable(std::string_view text, const std::string& file,
                            const Corrector& corrector, const Eigen::Matrix3Xd& beside) {
  CorrectedTable table;
  table.text.reserve(text.size());
  map::Lines lines(text, file);
  std::size_t width = 0;
  std::array<std::size_t, 3> columns{};
  for (std::string_view line; lines.Next(line);) {
    if (line.starts_with('#') || line.empty()) {
      table.text.append(line) += '\n';
      continue;
    }
    const auto words = map::PartsOf(line, ',');
    if (width == 0) {
      width = words.size();
      columns = ColumnsOf(words, lines.Where());
      table.text.append(line) += '\n';
      continue;
    }
    if (words.size() != width) {
      throw InputError(
          fmt::format("{}: {} values under {} columns", lines.Where(), words.size(), width));
    }
    Eigen::Vector3d read;
    for (std::size_t k = 0; k < 3; ++k) {
      read[k] = 1e-3 * map::NumberOf(words[columns[k]], lines.Where());
    }
    Eigen::Vector3d made;
    try {
      made = corrector.Made(read);
    } catch (const InputError& failure) {
      throw InputError(fmt::format("{}: {}", lines.Where(), failure.what()));
    }
    if (beside.size() > 0) made += beside.col(table.rows);
    table.largest = std::max(table.largest, (made - read).norm());
    ++table.rows;
    for (std::size_t i = 0; i < width; ++i) {
      if (i > 0) table.text += ',';
      const auto at = std::find(columns.begin(), columns.end(), i);
      if (at == columns.end()) {
        table.text += words[i];
      } else {
        table.text += fmt::format("{}", 1e3 * made[at - columns.begin()]);
      }
    }
    table.text += '\n';
  }
  if (width == 0) throw InputError(file + ": is empty; a table of positions has x_mm, y_mm, z_mm");
  return table;
}

}  // namespace abbe::compensation
