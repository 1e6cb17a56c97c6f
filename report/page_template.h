// The page without results: one HTML document that contains styles, fonts, scripts and Plotly. The
// build embeds it in the program.
#pragma once

#include <string_view>

namespace abbe::report {

// Placeholder in the policy of the page, of the sources that it may connect to.
inline constexpr std::string_view kConnectMark = "@@connect@@";
// Placeholder of the results, between the tags of the script element "results".
inline constexpr std::string_view kResultsMark = "@@results@@";

std::string_view PageTemplate();

}  // namespace abbe::report
