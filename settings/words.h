// The words of a text of lines.
//
//   settings::Trimmed("  X = 1\r");                // "X = 1"
//   settings::WordsOf("1  2\t3");                  // three
//   settings::PartsOf("a, ,b", ',');               // three, the second empty
//
// Units: none. Failure: none. Validity: ASCII texts with lines that end in LF or CR LF.
#pragma once

#include <string_view>
#include <vector>

namespace abbe::settings {

// Without the blanks at both ends.
std::string_view Trimmed(std::string_view text);

// The words between blanks and tabs.
std::vector<std::string_view> WordsOf(std::string_view text);

// The trimmed parts between separators, empty ones too.
std::vector<std::string_view> PartsOf(std::string_view text, char separator);

}  // namespace abbe::settings
