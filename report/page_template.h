// The page without its results: one HTML document with styles, fonts, scripts and Plotly inside,
// embedded in the program when it is built.
#pragma once

#include <string_view>

namespace abbe::report {

// Where the results belong in the page: between the tags of the script element "results".
inline constexpr std::string_view kResultsMark = "@@results@@";

std::string_view PageTemplate();

}  // namespace abbe::report
