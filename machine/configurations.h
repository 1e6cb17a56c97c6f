// The machine configurations of the volumetric error lecture, by name.
//
// The lecture names and draws seven; its text gives a kinematic chain for the column type only. The
// other chains are the project's interpretation of the names: the bridge types move the bridge
// along Y over a fixed table, the fixed bridge moves the table, the arm types move the arm or the
// table along X. The column type moves the table along X on Y.
// Failure: InputError for an unknown name, which lists all names and the nearest.
// Source: the volumetric error lecture (docs/theory-volumetric.md, Configurations).
// Validity: what carries a bridge does not matter here, only the order of the axes; three of the
// seven are therefore one chain.
#pragma once

#include <array>
#include <string_view>

#include "machine/chain.h"

namespace abbe::machine {

struct Configuration {
  std::string_view name;
  std::string_view chain;
};

inline constexpr std::array<Configuration, 7> kConfigurations = {{
    {"column", "[w X Y b Z t]"},
    {"moving-bridge", "[w b Y X Z t]"},
    {"gantry", "[w b Y X Z t]"},
    {"l-shaped-bridge", "[w b Y X Z t]"},
    {"fixed-bridge", "[w Y b X Z t]"},
    {"moving-horizontal-arm", "[w b X Z Y t]"},
    {"fixed-horizontal-arm", "[w X b Z Y t]"},
}};

// The chain of a name ("gantry") or of a text in brackets ("[w b Y X Z t]").
Chain ChainOf(std::string_view chain);

}  // namespace abbe::machine
