// The INI file of LinuxCNC: sections of KEY = VALUE.
//
//   settings::ParseIni(text, "mill.ini").at("TRAJ.LINEAR_UNITS");   // "mm"
//
// Comments begin with # or ; where a line or a word begins. Of a key that stands twice in a section
// the first counts. A value that goes on behind a \ keeps its first line.
// Units: none. Failure: InputError with file and line for a line that is neither [SECTION] nor KEY =
// VALUE, and for a key before any section.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace abbe::settings {

// "SECTION.KEY" -> value, without comment and blanks at its ends.
std::map<std::string, std::string> ParseIni(std::string_view text, const std::string& file);

}  // namespace abbe::settings
