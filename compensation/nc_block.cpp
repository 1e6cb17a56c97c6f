#include "compensation/nc_block.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "failure/failure.h"

namespace abbe::compensation {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

char Upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

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

void ReadBlock(std::string_view line, std::size_t line_number, std::vector<NcWord>& words) {
  words.clear();
  std::size_t at = 0;
  while (true) {
    while (at < line.size() && IsBlank(line[at])) ++at;
    if (at == line.size() || line.substr(at) == "%") return;
    const char letter = Upper(line[at]);
    if (letter == ';') {
      words.push_back({'(', 0.0, line.substr(at)});
      return;
    }
    if (letter == '(') {
      const std::size_t end = line.find(')', at);
      if (end == std::string_view::npos) RefuseLine(line_number, "the comment does not end");
      words.push_back({'(', 0.0, line.substr(at, end - at + 1)});
      at = end + 1;
      continue;
    }
    if (letter < 'A' || letter > 'Z' || letter == 'O') {
      RefuseLine(line_number,
                 fmt::format("\"{}\" is not supported: parameters, expressions, subprograms and "
                             "deletable blocks cannot be corrected; expand them first",
                             line.substr(at, 10)));
    }
    std::size_t begin = at + 1;
    while (begin < line.size() && IsBlank(line[begin])) ++begin;
    const std::size_t sign = begin < line.size() && line[begin] == '+' ? 1 : 0;
    double value = 0.0;
    const auto [end, error] = std::from_chars(line.data() + begin + sign, line.data() + line.size(),
                                              value, std::chars_format::fixed);
    if (error != std::errc() || !std::isfinite(value)) {  // from_chars accepts "nan" and "inf"
      RefuseLine(line_number,
                 fmt::format("\"{}\" is not a letter with a number", line.substr(at, 10)));
    }
    const std::size_t stop = end - line.data();
    words.push_back({letter, value, line.substr(at, stop - at)});
    at = stop;
  }
}

}  // namespace abbe::compensation
