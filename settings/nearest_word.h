// Spelling suggestion: the known word with the fewest edits from the one that was written.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace abbe::settings {

// Returns the word of `known` with the smallest Damerau-Levenshtein distance (adjacent letters
// swapped count as one edit) to `word`, or an empty string when `known` is empty.
std::string NearestWord(std::string_view word, const std::vector<std::string>& known);

}  // namespace abbe::settings
