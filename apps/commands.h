// The subcommands, in the order in which `abbe --help` lists them.
#pragma once

#include <array>

#include "apps/command.h"

namespace abbe::apps {

inline constexpr std::array<AddCommand, 0> kCommands{};

}  // namespace abbe::apps
