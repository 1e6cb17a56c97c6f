// What else could do what a learned term does: parameters of the simulation, and named causes.
//
//   const Confounding confounding = ConfoundingOf(fit, candidate, base, causes);
//   confounding.imitated;           // 0.3: parameters can make 30 % of its effect, rms
//
// In the metric of the data. Imitated: 1 - sqrt(S / C'C), of the term's column C and its
// information S free of all parameters. Named causes, each with the shapes that what is left asks
// for: the cosine of their columns with that of the term, free of all parameters.
// Units: none. Failure: that of the fit. Source: Kennedy and O'Hagan, J. R. Statist. Soc. B 63
// (2001), on discrepancy and parameters. Validity: to first order at the fit.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/fit.h"

namespace abbe::learned {

struct Confounding {
  double imitated = 0.0;
  std::string nearest = {};  // "backlash:X"; empty: no cause has anything of it
  double cosine = 0.0;
  std::vector<std::string> group = {};  // causes with a cosine above kAlike, that nearest first
};
inline constexpr double kAlike = 0.9;

// `fit` has the term among its causes; `base` has none of `causes`.
Confounding ConfoundingOf(const diagnosis::Fit& fit, const diagnosis::Candidate& term,
                          const std::shared_ptr<const diagnosis::Fit>& base,
                          const std::vector<diagnosis::Candidate>& causes);

}  // namespace abbe::learned
