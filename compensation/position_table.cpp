#include "compensation/position_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "failure/failure.h"
#include "settings/column_name.h"
#include "settings/table_cells.h"
#include "settings/unit.h"

namespace abbe::compensation {
namespace {

bool Names(std::string_view quantity, char axis) {
  return quantity.size() == 1 && std::tolower(static_cast<unsigned char>(quantity[0])) == axis;
}

bool IsLength(const settings::Unit& unit) {
  return settings::MeasureTheSame(unit, settings::WrittenUnit("mm"));
}

std::vector<std::string> Unquoted(const std::vector<std::string_view>& cells) {
  std::vector<std::string> columns(cells.size());
  std::ranges::transform(cells, columns.begin(), settings::Unquoted);
  return columns;
}

}  // namespace

PositionTable::PositionTable(std::string_view text, const std::string& file,
                             const std::array<bool, 3>& needed)
    : text_(text), lines_(text, file), file_(file), needed_(needed) {}

bool PositionTable::Next() {
  row_ = false;
  if (!lines_.Next(line_)) {
    if (!named_) {
      throw InputError(file_ + ": is empty; a table of positions has x_mm, y_mm and z_mm");
    }
    if (!has_rows_) {
      throw InputError(file_ + ": has no rows under x_mm, y_mm, z_mm; it may be cut off");
    }
    return false;
  }
  if (line_.find('\0') != std::string_view::npos) {
    throw InputError(Where() + ": is not UTF-8 text; save the table as CSV (UTF-8)");
  }
  const std::string_view text = settings::WithoutByteOrderMark(line_);
  if (text.empty() || text.starts_with('#')) return true;
  if (!named_) {
    TakeNames(text);
  } else {
    TakeRow();
  }
  return true;
}

std::string_view PositionTable::End() const {
  const char* const end = line_.data() + line_.size();
  return end < text_.data() + text_.size() && *end == '\r' ? "\r\n" : "\n";
}

void PositionTable::RefuseTwoOf(char axis, const std::vector<std::string>& columns) const {
  std::vector<std::string> lengths;
  for (const std::string& column : columns) {
    const settings::ColumnName name = settings::ColumnNameOf(column);
    if (Names(name.quantity, axis) && IsLength(name.unit)) lengths.push_back(column);
  }
  if (lengths.size() < 2) return;
  throw InputError(fmt::format("{}: the columns {} are all positions of {}; rename all but one",
                               Where(), fmt::join(lengths, " and "),
                               static_cast<char>(std::toupper(axis))));
}

bool PositionTable::HasDecimalCommas() const {
  map::Lines rows = lines_;
  for (std::string_view row; rows.Next(row);) {
    if (row.starts_with('#')) continue;
    const auto cells = settings::CellsOf(row, separator_);
    for (std::size_t k = 0; k < 3; ++k) {
      if (columns_[k] >= cells.size()) continue;
      const std::string_view cell = cells[columns_[k]];
      if (settings::WithDecimalPoint(cell, separator_) != cell) return true;
    }
  }
  return false;
}

void PositionTable::TakeNames(std::string_view names) {
  named_ = true;
  separator_ = settings::SeparatorOf(names);
  words_ = settings::CellsOf(names, separator_);
  width_ = words_.size();
  const std::vector<std::string> columns = Unquoted(words_);
  for (std::size_t k = 0; k < 3; ++k) {
    const char axis = "xyz"[k];
    const auto found = std::ranges::find_if(columns, [&](const std::string& column) {
      return Names(settings::ColumnNameOf(column).quantity, axis);
    });
    columns_[k] = kNone;
    if (found == columns.end() && !needed_[k]) continue;
    if (found == columns.end()) {
      throw InputError(fmt::format(
          "{}: there is no column {}_mm among {}; a table of positions has x_mm, y_mm and z_mm, or "
          "\"X [mm]\" and so on",
          Where(), axis, fmt::join(columns, ", ")));
    }
    const settings::Unit unit = settings::ColumnNameOf(*found).unit;
    if (!IsLength(unit)) {
      throw InputError(
          fmt::format("{}: the column {} states no unit of length; name it {}_mm, or \"{} [mm]\"",
                      Where(), *found, axis, static_cast<char>(std::toupper(axis))));
    }
    RefuseTwoOf(axis, columns);
    columns_[k] = found - columns.begin();
    si_[k] = unit.si;
  }
  has_decimal_commas_ = HasDecimalCommas();
}

void PositionTable::TakeRow() {
  words_ = settings::CellsOf(line_, separator_);
  if (words_.size() != width_) {
    throw InputError(fmt::format("{}: {} values under {} columns", Where(), words_.size(), width_));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (columns_[k] == kNone) continue;
    const std::string number =
        settings::WithDecimalPoint(settings::Unquoted(words_[columns_[k]]), separator_);
    position_[k] = si_[k] * map::NumberOf(number, Where());
  }
  row_ = has_rows_ = true;
}

std::string PositionTable::WithPosition(const Eigen::Vector3d& position) const {
  std::string text;
  for (std::size_t i = 0; i < width_; ++i) {
    if (i > 0) text += separator_;
    const auto at = std::ranges::find(columns_, i) - columns_.begin();
    if (at == 3) {
      text += words_[i];
      continue;
    }
    std::string number = fmt::format("{}", position[at] / si_[at]);
    if (has_decimal_commas_) std::ranges::replace(number, '.', ',');
    text += number;
  }
  return text;
}

}  // namespace abbe::compensation
