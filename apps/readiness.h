// What a machine file lacks for each command.
//
//   for (const CommandReadiness& each : ReadinessOf("mill.toml")) ...
//
// Failure: InputError with file, line and key for a file that no command takes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace abbe::apps {

struct CommandReadiness {
  std::string commands;              // "align, sweep"
  std::vector<std::string> missing;  // empty: ready
};

std::vector<CommandReadiness> ReadinessOf(const std::filesystem::path& path);

}  // namespace abbe::apps
