// The catalogue of causes as a table of Markdown: docs/causes.md, `abbe causes`.
// Units: those of the keys.
// Failure: none.
// Source: the words of each cause, simulation/causes/.
#pragma once

#include <string>

namespace abbe::simulation {

// One row for each cause, in the order of the registry: id, words, keys with their units.
std::string CausesTable();

}  // namespace abbe::simulation
