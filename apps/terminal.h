// What a terminal can show.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace abbe::apps {

// Whether the stream goes to a terminal that can write over a line (TERM is not "dumb").
bool IsTerminal(std::FILE* stream);

// Columns of the terminal on standard error; COLUMNS, or 80, where it does not say.
std::size_t TerminalWidth();

// "7 s", "2 min 05 s", "1 h 03 min"
std::string DurationText(double seconds);

}  // namespace abbe::apps
