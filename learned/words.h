// A learned term in words, with what on machines makes such things.
//
//   InWords(term);       // "EYX steps by 1.21 +- 0.04 um at x = 31.4 +- 0.1 mm"
//   SuggestionFor(term); // "a joint of two scales or guideways"; a suggestion, not a finding
//
// Units: as printed. Failure: none.
// Source: own experience of machine tools, from one table; docs/learned.md prints it.
// Validity: a form says little of its maker: the table is where to look first.
#pragma once

#include <string>

#include "simulation/learned/learned_term.h"

namespace abbe::learned {

// Form, place and size, each with its U95.
std::string InWords(const simulation::LearnedTerm& term);

// Empty: the table has nothing for this form at this stage.
std::string SuggestionFor(const simulation::LearnedTerm& term);

// The table of suggestions, Markdown: forms by stages.
std::string MakersTable();

}  // namespace abbe::learned
