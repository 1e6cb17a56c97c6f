#include "compensation/nc_comment.h"

#include <fmt/format.h>

#include <cmath>

#include "compensation/nc_expression.h"
#include "compensation/nc_source.h"
#include "failure/failure.h"

namespace abbe::compensation {
namespace {

constexpr int kShownDecimals = 6;

// "%d", "%f", "%lf" and "%.3f" in a comment that shows values: their decimals. What was taken.
std::size_t TakeFormat(std::string_view text, int& decimals) {
  if (text.starts_with("%d")) {
    decimals = 0;
    return 2;
  }
  for (const std::string_view plain : {"%f", "%lf"}) {
    if (!text.starts_with(plain)) continue;
    decimals = kShownDecimals;
    return plain.size();
  }
  constexpr std::size_t kSize = 4;  // "%.3f"
  if (text.size() < kSize || !text.starts_with("%.") || text[3] != 'f') return 0;
  if (text[2] < '0' || text[2] > '9') return 0;
  decimals = text[2] - '0';
  return kSize;
}

}  // namespace

std::string CommentText(std::string_view text, std::size_t line_number,
                        const NcParameters& parameters) {
  std::string start;
  for (const char c : text.substr(0, 8)) {
    if (c != ' ') start += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  }
  const bool is_abort = start.starts_with("(abort,");
  if (is_abort) {
    RefuseLine(line_number, fmt::format("the program ends itself here: {}", text.substr(0, 60)));
  }
  if (!start.starts_with("(debug,") && !start.starts_with("(print,") &&
      !start.starts_with("(log,")) {
    return std::string(text);
  }
  std::string out;
  int decimals = kShownDecimals;
  for (std::size_t i = 0; i < text.size();) {
    if (const std::size_t taken = TakeFormat(text.substr(i), decimals); taken > 0) {
      i += taken;
      continue;
    }
    NcCursor cursor(text.substr(i), line_number, parameters);
    if (text[i] != '#') {
      out += text[i++];
      continue;
    }
    try {
      const double value = cursor.Value();
      // What only the control knows, it also shows.
      out += std::isnan(value) ? std::string(text.substr(i, cursor.at()))
                               : fmt::format("{:.{}f}", value, decimals);
      i += cursor.at();
    } catch (const InputError&) {
      out += text[i++];  // no parameter: a sign
    }
  }
  return out;
}

}  // namespace abbe::compensation
