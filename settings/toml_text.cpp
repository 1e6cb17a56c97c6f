#include "settings/toml_text.h"

#include <fmt/format.h>

#include <cmath>

namespace abbe::settings {

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(letter) < 0x20 ? ' ' : letter;
  }
  return quoted + '"';
}

std::string Float(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  if (std::isnan(value)) return "nan";
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string Floats(std::span<const double> values) {
  std::string list = "[";
  for (const double value : values) list += (list.size() > 1 ? ", " : "") + Float(value);
  return list + "]";
}

std::string QuotedList(std::span<const std::string> texts) {
  std::string list = "[";
  for (const std::string& text : texts) list += (list.size() > 1 ? ", " : "") + Quoted(text);
  return list + "]";
}

}  // namespace abbe::settings
