// The subcommands, in the order in which `abbe --help` lists them.
#pragma once

#include <array>

#include "apps/command.h"

namespace abbe::apps {

void AddReport(CLI::App& program, int& exit_code);
void AddSensitivity(CLI::App& program, int& exit_code);

inline constexpr std::array<AddCommand, 2> kCommands{AddReport, AddSensitivity};

}  // namespace abbe::apps
