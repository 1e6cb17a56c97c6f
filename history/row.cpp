#include <cstdlib>

#include "history/database.h"

namespace abbe::history {

// SQLite gives the result of an expression, count(*), as text.
long long Row::WholeAt(std::size_t column) const {
  const Value& value = values_.at(column);
  if (const auto* whole = std::get_if<std::optional<long long>>(&value)) return whole->value_or(0);
  if (const auto* text = std::get_if<std::optional<std::string>>(&value)) {
    return std::strtoll(text->value_or("0").c_str(), nullptr, 10);
  }
  return static_cast<long long>(std::get<std::optional<double>>(value).value_or(0.0));
}

std::optional<double> Row::RealAt(std::size_t column) const {
  const Value& value = values_.at(column);
  if (const auto* real = std::get_if<std::optional<double>>(&value)) return *real;
  if (const auto* whole = std::get_if<std::optional<long long>>(&value)) {
    return *whole ? std::optional(static_cast<double>(**whole)) : std::nullopt;
  }
  const auto& text = std::get<std::optional<std::string>>(value);
  return text ? std::optional(std::strtod(text->c_str(), nullptr)) : std::nullopt;
}

std::string Row::TextAt(std::size_t column) const {
  const auto* text = std::get_if<std::optional<std::string>>(&values_.at(column));
  return text != nullptr ? text->value_or("") : "";
}

}  // namespace abbe::history
