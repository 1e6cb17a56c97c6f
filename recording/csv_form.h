// The signature of the CSV form, for its reader and its writer;
// docs/recordings.md describes the form.
#pragma once

#include <string_view>

namespace abbe::recording {

inline constexpr std::string_view kSignature = "# abbe-recording = 1";

}  // namespace abbe::recording
