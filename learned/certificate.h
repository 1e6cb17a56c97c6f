// Two of the tests that a learned term has to pass: false discovery, and beyond what was fitted.
//
//   const double by_chance = ByChance(search, false);
//   const std::string regime = RegimeOf(fit, learned, place);
//
// False discovery: the least chance that the whole grammar finds in nothing, drawn kDraws times
// through the information of the fit (part_scan.h), which has the priors and the noise, drifting as
// drifting. Below what so many draws show, the effective number of atoms that their median stands
// for. Lags, plays and products, which are asked row by row, count one by one (Bonferroni).
// Regime: what the channel does in the outer fifths of the range, at both ends, is set free, and
// the coefficient of the inner three fifths held against that of the outer two.
// Units: none. Failure: none. Source: Davison and Hinkley, Bootstrap Methods (1997), 4.2.
#pragma once

#include <string>

#include "learned/term_search.h"

namespace abbe::learned {

struct Learned;

inline constexpr int kDraws = 1000;

// For the best of a search; for a smooth function the chance that the structure search states.
double ByChance(const TermSearch& search, bool is_smooth);

// kHolds, kFails or kUntold (simulation/learned/learned_term.h); `place` among the causes of the
// fit.
std::string RegimeOf(const diagnosis::Fit& fit, const Learned& learned, std::size_t place);

}  // namespace abbe::learned
