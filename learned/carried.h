// Learned terms that go from one machine to another, and the names that people give them.
//
//   campaign.CarryOn(CarriedFrom({"other_mill.causes.toml"}));
//   const std::string named = WithName(text, "mill.causes.toml", "1", naming);
//
// A file is an extended model of any machine with tables [[learned]]. A term that was certified
// there competes as a named cause (LearnedCause::CarriedOn), under its name, or its expression
// where nobody named it.
// Units: as simulation/learned/learned_term.h. Shapes: terms in the order of the files.
// Failure: InputError with the file and line for a file without learned terms, a term without a
// certificate, a name that is a known cause's, or two terms of one name at one object.
// Source: docs/learned.md.
// Validity: numbers within an expression (a place, a period) are those of the other machine.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "simulation/learned/learned_term.h"

namespace abbe::learned {

// All terms of the files.
std::vector<std::shared_ptr<const simulation::LearnedCause>> CarriedFrom(
    const std::vector<std::filesystem::path>& files);

struct Naming {
  std::string name, words;  // empty words: those before stay
};
// `text` of a file with the term (1: the first, or its expression) named; `file` for messages.
std::string WithName(const std::string& text, const std::string& file, const std::string& term,
                     const Naming& naming);

}  // namespace abbe::learned
