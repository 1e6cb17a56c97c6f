#include "compensation/nc_block.h"

#include <fmt/format.h>

#include <cmath>

#include "failure/failure.h"

namespace abbe::compensation {
namespace {

// Takes a setting "#1 = 3" whose # is taken.
void ReadSetting(NcCursor& cursor, NcBlock& block) {
  const NcCursor::Parameter parameter = cursor.ParameterName();
  if (!cursor.Take('=')) cursor.Refuse("a parameter without = and a value");
  block.settings.push_back({parameter, cursor.Value()});
}

NcWord ReadComment(NcCursor& cursor, char first) {
  const std::string_view rest = cursor.Rest();
  const std::size_t end = first == ';' ? rest.size() - 1 : rest.find(')');
  if (end == std::string_view::npos) cursor.Refuse("the comment does not end");
  cursor.Skip(end + 1);
  return {'(', 0.0, rest.substr(0, end + 1)};
}

bool IsWordLetter(char c) {
  return (c >= 'A' && c <= 'Z' && c != 'O') || c == '@' || c == '^' || c == '$';
}

}  // namespace

void RefuseLine(std::size_t line_number, const std::string& what) {
  throw InputError(fmt::format("line {}: {}", line_number, what));
}

int CodeTimes10(const NcWord& word) {
  constexpr double kLargest = 1000.0, kRounding = 1e-6;
  if (!(word.value >= 0.0 && word.value < kLargest)) return -1;
  const double exact = 10 * word.value;
  if (std::abs(exact - std::round(exact)) > kRounding) return -1;
  return static_cast<int>(std::lround(exact));
}

void ReadBlock(std::string_view line, std::size_t line_number, const NcParameters& parameters,
               NcBlock& block) {
  block.words.clear();
  block.settings.clear();
  NcCursor cursor(line, line_number, parameters);
  block.is_deletable = cursor.Take('/');
  for (char first = cursor.Peek(); first != '\0'; first = cursor.Peek()) {
    if (cursor.Rest() == "%" || cursor.Rest() == "%\r") return;
    if (first == ';' || first == '(') {
      block.words.push_back(ReadComment(cursor, first));
      continue;
    }
    if (cursor.Take('#')) {
      ReadSetting(cursor, block);
      continue;
    }
    const std::string_view rest = cursor.Rest();
    const std::size_t start = cursor.at();
    if (!IsWordLetter(first)) {
      RefuseLine(line_number, fmt::format("\"{}\" is no word of a program", rest.substr(0, 10)));
    }
    cursor.Skip(1);
    if (!cursor.IsAtValue()) {
      RefuseLine(line_number,
                 fmt::format("\"{}\" is not a letter with a number", rest.substr(0, 10)));
    }
    const double value = cursor.Value();
    const std::string_view text = rest.substr(0, cursor.at() - start);
    if (std::isinf(value)) RefuseLine(line_number, fmt::format("\"{}\" is too large", text));
    const bool is_literal = text.find_first_of("#[") == std::string_view::npos;
    block.words.push_back({first, value, text, is_literal});
  }
}

}  // namespace abbe::compensation
