#include "compensation/position_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "failure/failure.h"
#include "settings/column_name.h"
#include "settings/unit.h"

namespace abbe::compensation {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// A cell that a spreadsheet has quoted, without the quotes.
std::string_view Unquoted(std::string_view cell) {
  if (cell.size() < 2 || !cell.starts_with('"') || !cell.ends_with('"')) return cell;
  return cell.substr(1, cell.size() - 2);
}

bool Names(std::string_view quantity, char axis) {
  return quantity.size() == 1 && std::tolower(static_cast<unsigned char>(quantity[0])) == axis;
}

}  // namespace

PositionTable::PositionTable(std::string_view text, const std::string& file)
    : lines_(text, file), file_(file) {}

bool PositionTable::Next() {
  row_ = false;
  if (!lines_.Next(line_)) {
    if (!named_) {
      throw InputError(file_ + ": is empty; a table of positions has x_mm, y_mm and z_mm");
    }
    return false;
  }
  std::string_view text = line_;
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (text.empty() || text.starts_with('#')) return true;
  if (!named_) {
    TakeNames(text);
  } else {
    TakeRow();
  }
  return true;
}

void PositionTable::TakeNames(std::string_view names) {
  named_ = true;
  for (const char separator : {'\t', ';'}) {
    if (names.find(separator) != std::string_view::npos) separator_ = separator;
  }
  words_ = map::PartsOf(names, separator_);
  width_ = words_.size();
  for (std::size_t k = 0; k < 3; ++k) {
    const char axis = "xyz"[k];
    const auto found = std::ranges::find_if(words_, [&](std::string_view word) {
      const auto name = settings::ColumnNameOf(Unquoted(word));
      return Names(name.quantity, axis);
    });
    if (found == words_.end()) {
      throw InputError(fmt::format(
          "{}: there is no column {}_mm among {}; a table of positions has x_mm, y_mm and z_mm, or "
          "\"X [mm]\" and so on",
          Where(), axis, fmt::join(words_, ", ")));
    }
    const settings::Unit unit = settings::ColumnNameOf(Unquoted(*found)).unit;
    if (!settings::MeasureTheSame(unit, settings::WrittenUnit("mm"))) {
      throw InputError(
          fmt::format("{}: the column {} states no unit of length; name it {}_mm, or \"{} [mm]\"",
                      Where(), *found, axis, static_cast<char>(std::toupper(axis))));
    }
    columns_[k] = found - words_.begin();
    si_[k] = unit.si;
  }
}

double PositionTable::NumberIn(std::string_view word) const {
  if (separator_ == ',' || std::ranges::count(word, ',') != 1) {
    return map::NumberOf(word, Where());
  }
  std::string number(word);
  number[number.find(',')] = '.';
  return map::NumberOf(number, Where());
}

void PositionTable::TakeRow() {
  words_ = map::PartsOf(line_, separator_);
  if (words_.size() != width_) {
    throw InputError(fmt::format("{}: {} values under {} columns", Where(), words_.size(), width_));
  }
  for (std::size_t k = 0; k < 3; ++k) position_[k] = si_[k] * NumberIn(words_[columns_[k]]);
  row_ = true;
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
    if (words_[i].find(',') != std::string_view::npos) std::ranges::replace(number, '.', ',');
    text += number;
  }
  return text;
}

}  // namespace abbe::compensation
