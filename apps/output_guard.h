// Protection of files against overwriting, for all commands, before any of them starts.
#pragma once

#include <CLI/CLI.hpp>

namespace abbe::apps {

// Adds the flag --force to every command that writes a file. After parsing, `program`
// throws InputError if an output would overwrite an input or a recording; every
// existing file named by another option is an input. recording/whole_file.h later
// refuses to overwrite a file of another kind.
void GuardOutputs(CLI::App& program);

}  // namespace abbe::apps
