#include "apps/rounded.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace abbe::apps {
namespace {

constexpr int kMost = 9;  // decimals

// 0.0996 rounds to 0.10: two decimals, not three.
int DecimalsOf(double U, int fallback) {
  if (!(U > 0.0) || !std::isfinite(U)) return fallback;
  const double rounded = std::stod(fmt::format("{:.1e}", U));
  const int exponent = static_cast<int>(std::floor(std::log10(rounded) + 1e-9));
  return std::clamp(1 - exponent, 0, kMost);
}

}  // namespace

Decimals::Decimals(double U, int fallback) : count_(DecimalsOf(U, fallback)) {}

std::string Decimals::operator()(double value) const {
  std::string text = fmt::format("{:.{}f}", value, count_);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.starts_with('-') ? text.substr(1) : text;
}

std::string PlusMinus(double value, double U) {
  const Decimals decimals(U);
  return fmt::format("{} +- {}", decimals(value), decimals(U));
}

}  // namespace abbe::apps
