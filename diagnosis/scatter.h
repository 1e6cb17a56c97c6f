// Runs that scatter more than their stated noise lets them, whatever it depends on.
//
// The sum of squares of what a fit leaves of a run, in units of the stated noise, against
// chi-square of as many degrees of freedom as the run has rows: a portmanteau test. A stated noise
// is believed to 5
// %. Source: ISO/IEC Guide 98-3:2008, G.3 (chi-square of residuals). Units: amplitude in units of
// the stated noise.
#pragma once

#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/unexplained.h"

namespace abbe::diagnosis {

inline constexpr double kNoiseIsKnown = 1.05;

// The variable is kScatter, the object the name of the run.
std::vector<Leftover> RunsThatScatter(const Fit& fit);

}  // namespace abbe::diagnosis
