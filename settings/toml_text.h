// Text of TOML keys and values, for the programs that write TOML files.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace abbe::settings {

// A text in quotes; control characters, which TOML does not allow there, become blanks, and bytes
// that are not UTF-8 become question marks.
std::string Quoted(std::string_view text);

// Whether all of it is UTF-8.
bool IsUtf8(std::string_view text);

// A key of a table: bare where TOML allows it, else in quotes.
std::string Key(std::string_view name);

// A float, in the shortest form that reads back the same.
std::string Float(double value);

// "[1.0, 2.5]"
std::string Floats(std::span<const double> values);
// The same for a vector with data() and size().
template <typename Vector>
std::string Floats(const Vector& values) {
  return Floats(std::span<const double>(values.data(), static_cast<std::size_t>(values.size())));
}

// ["a", "b"]
std::string QuotedList(std::span<const std::string> texts);

}  // namespace abbe::settings
