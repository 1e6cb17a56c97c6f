// Protection of files against overwriting, for all commands, before any of them starts.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

namespace abbe::apps {

// Adds the flag --force to every command that writes a file. After parsing, `program`
// throws InputError if an output would overwrite an input or a recording; every
// existing file named by another option is an input. recording/whole_file.h later
// refuses to overwrite a file of another kind.
// So it does, before any work, if an output lies in a folder that cannot be written.
void GuardOutputs(CLI::App& program);

// The latter for an output that has a name without an option.
void RefuseUnwritable(const std::filesystem::path& output);

}  // namespace abbe::apps
