// The strongest sine in readings about the means of their stays.
//
//   const Sine sine = StrongestSine(stays, FrequenciesUpTo(10.0, span));
//   const std::vector<Stay> left = Without(sine, stays);
//
// The best of the frequencies given, then between its neighbours: half a step aside, a sine that is
// large over the noise would leave more than a memory of the readings does.
// Units: those of the readings, s, Hz. Shapes: one list of times and readings a stay, together at
// least four more readings than stays. Failure: none; gain 0 where no sine can be seen.
// Source: Lomb, Astrophys. Space Sci. 39 (1976). Validity: one sine on white noise.
// For use within estimation/ only.
#pragma once

#include <vector>

#include "estimation/noise_memory.h"

namespace abbe::estimation {

struct Sine {
  double frequency = 0.0, sd = 0.0;  // sd: of what it leaves
  double gain = 0.0;                 // logarithm of the likelihood, one of all frequencies tried
};

// Those that even readings over `span` tell apart.
std::vector<double> FrequenciesUpTo(double highest, double span);
// Where the readings are not quite even a line beyond them has no alias among them.
std::vector<double> FrequenciesOfMains(double span);

Sine StrongestSine(const std::vector<Stay>& stays, const std::vector<double>& frequencies);
std::vector<Stay> Without(const Sine& sine, std::vector<Stay> stays);

}  // namespace abbe::estimation
