#include "map/words.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "failure/failure.h"

namespace abbe::map {

double NumberOf(std::string_view word, std::string_view where) {
  std::string_view digits = word;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(number)) {
    throw InputError(fmt::format("{}: \"{}\" is not a number; correct it", where, word));
  }
  if (std::abs(number) > kLargest) {
    throw InputError(fmt::format("{}: {} is beyond anything measured; correct it", where, word));
  }
  return number;
}

std::vector<double> NumbersOf(std::string_view text, std::string_view where) {
  std::vector<double> numbers;
  for (const std::string_view word : WordsOf(text)) numbers.push_back(NumberOf(word, where));
  return numbers;
}

bool Lines::Next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line = rest_.substr(0, end);
  if (line.ends_with('\r')) line.remove_suffix(1);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  ++number_;
  return true;
}

std::string Lines::Where() const { return fmt::format("{}:{}", file_, number_); }

}  // namespace abbe::map
