#include "settings/toml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace abbe::settings {

namespace {

// Number of bytes of the first character of `text`; 0 when it is not valid UTF-8.
std::size_t CharacterSize(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  unsigned code = first & (0xFFu >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0u) != 0x80u) return 0;
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  const unsigned least = size == 4 ? 0x10000u : size == 3 ? 0x800u : 0x80u;
  return code < least || code > 0x10FFFFu || (code >= 0xD800u && code <= 0xDFFFu) ? 0 : size;
}

}  // namespace

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  while (!text.empty()) {
    const std::size_t size = CharacterSize(text);
    const char letter = text.front();
    if (letter == '"' || letter == '\\') quoted += '\\';
    if (size == 0) {
      quoted += '?';
    } else if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F) {
      quoted += ' ';
    } else {
      quoted += text.substr(0, size);
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return quoted + '"';
}

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = CharacterSize(text);
    if (size == 0) return false;
    text.remove_prefix(size);
  }
  return true;
}

std::string Key(std::string_view name) {
  const bool bare = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
  return bare ? std::string(name) : Quoted(name);
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
