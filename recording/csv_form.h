// The parts of the CSV form that its reader and its writer share; docs/recordings.md has them all.
#pragma once

#include <string_view>

namespace abbe::recording {

inline constexpr std::string_view kSignature = "# abbe-recording = 1";

}  // namespace abbe::recording
