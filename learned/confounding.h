// What else could do what a learned term does: parameters of the simulation, and named causes.
//
//   ImitatedByRows(fit, term, chi_square);      // 0.3: parameters can make 30 % of it, rms
//   const Confounding confounding = ConfoundingOf(fit, candidate, term, base, named);
//
// Imitated: 1 - sqrt(S / C'C) of the effect, less a constant and, but for a straight line itself,
// straight lines in its variables (zeros, scales and squarenesses are for those); S is what of it
// is left free of all parameters. In the metric of the data, or quickly, each row by its weight,
// which counts what is common to the rows of a run with drifting noise for too much. Named causes,
// each with the shapes that what is left asks for: the cosine of their columns with that of the
// term, free of all parameters.
// Units: none. Failure: that of the fit. Source: Kennedy and O'Hagan, J. R. Statist. Soc. B 63
// (2001), on discrepancy and parameters. Validity: to first order at the fit.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "simulation/learned/learned_term.h"

namespace abbe::learned {

struct Confounding {
  double imitated = 0.0;     // in the metric of the data
  std::string nearest = {};  // "backlash:X"; empty: no cause has anything of it
  double cosine = 0.0;
  std::vector<std::string> group = {};  // causes with a cosine above kAlike, that nearest first
};
inline constexpr double kAlike = 0.9;

// Named causes, each with the shape that what is left beside a fit asks for, but for those found.
std::vector<diagnosis::Candidate> NamedBeside(const diagnosis::Fit& base,
                                              const std::vector<diagnosis::Candidate>& found);

// `chi_square`: explained by the term where it was searched for.
double ImitatedByRows(const diagnosis::Fit& fit, const simulation::LearnedTerm& term,
                      double chi_square);

// `fit` has the term among its causes; `base` none, with the same runs.
Confounding ConfoundingOf(const diagnosis::Fit& fit, const diagnosis::Candidate& term,
                          const simulation::LearnedTerm& what, const diagnosis::Fit& base,
                          const std::vector<diagnosis::Candidate>& named);

}  // namespace abbe::learned
