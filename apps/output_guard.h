// What a command may write over: decided for all commands at once, before any of them works.
#pragma once

#include <CLI/CLI.hpp>

namespace abbe::apps {

// Gives every command that writes a file the flag --force, and lets `program` look, when its words
// are understood, whether one of its outputs would destroy an input or a recording: InputError.
// What any other word names and is there counts as an input. Another kind of file than is written
// is refused later, by recording/whole_file.h.
void GuardOutputs(CLI::App& program);

}  // namespace abbe::apps
