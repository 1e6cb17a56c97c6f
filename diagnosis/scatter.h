// Runs that do not scatter as their stated noise would, whatever it depends on.
//
// What a fit leaves of a run, in units of the stated noise, is white and of variance one where the
// simulation is right. Two portmanteau tests of each run:
//   scatter   the sum of squares against chi-square of as many degrees of freedom as it has rows; a
//             stated noise is believed to 5 %
//   memory    the autocorrelations a_k of n rows in time, n (n + 2) sum a_k^2 / (n - k) over the
//             first kLags of each channel, against chi-square of as many degrees of freedom, where
//             the a_k are positive on the whole
// A channel that scatters far more than stated while nothing moves (measured_noise.h) is reported
// too, also where its runs are whitened with that noise.
// Source: ISO/IEC Guide 98-3:2008, G.3 (chi-square of residuals); Ljung and Box, Biometrika 65
// (1978). Units: amplitude in units of the stated noise.
#pragma once

#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/unexplained.h"

namespace abbe::diagnosis {

// The variable is kScatter or kMemory, the object the name of the run; or kAtRest, the channel.
std::vector<Leftover> RunsThatScatter(const Fit& fit);

}  // namespace abbe::diagnosis
