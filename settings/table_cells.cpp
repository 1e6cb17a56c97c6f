#include "settings/table_cells.h"

#include <algorithm>

#include "settings/words.h"

namespace abbe::settings {

std::string_view WithoutByteOrderMark(std::string_view line) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  return line.starts_with(kByteOrderMark) ? line.substr(kByteOrderMark.size()) : line;
}

char SeparatorOf(std::string_view line) {
  for (const char separator : {';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

std::vector<std::string_view> CellsOf(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  std::size_t first = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (line[i] != separator || quoted) continue;
    cells.push_back(Trimmed(line.substr(first, i - first)));
    first = i + 1;
  }
  cells.push_back(Trimmed(line.substr(first)));
  return cells;
}

std::string Unquoted(std::string_view cell) {
  std::string text;
  bool quoted = false;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    if (cell[i] != '"') {
      text += cell[i];
      continue;
    }
    if (quoted && cell.substr(i + 1).starts_with('"')) text += cell[i++];
    quoted = !quoted;
  }
  return std::string(Trimmed(text));
}

std::string WithDecimalPoint(std::string_view number, char separator) {
  std::string text(number);
  if (separator != ',' && text.find('.') == std::string::npos &&
      std::ranges::count(text, ',') == 1) {
    text[text.find(',')] = '.';
  }
  return text;
}

}  // namespace abbe::settings
