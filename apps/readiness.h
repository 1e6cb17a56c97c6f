// What a machine file lacks for each command.
//
//   for (const CommandReadiness& each : ReadinessOf(settings::Document::Read("mill.toml"))) {
//     std::cout << each.commands << (each.missing.empty() ? ": ready" : "") << "\n";
//   }
//
// Failure: InputError with file, line and key for a file that no command takes.
#pragma once

#include <string>
#include <vector>

#include "settings/document.h"

namespace abbe::apps {

struct CommandReadiness {
  std::string commands;              // "align, sweep"
  std::vector<std::string> missing;  // empty: ready
};

std::vector<CommandReadiness> ReadinessOf(const settings::Document& machine_file);

}  // namespace abbe::apps
