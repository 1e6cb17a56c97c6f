// What does not belong: an error of a machine that no machine of its population has, and a campaign
// that is of another machine than it is said to be.
//
//   for (const OddError& odd : OddErrors(fit)) odd.p_value;
//   for (const OddIdentity& odd : OddIdentities(fit, campaigns, {})) odd.fits;
//
// In coordinates in which the population is white (V = L L', B = L' H L, w = L' h) what a machine
// tells of one error, all others marginalised, is along the eigenvectors of B
//
//   w_k ~ N(0, f^2 B_k^2 + B_k),   ln f ~ N(0, s^2)
//
// the sizes estimated without this machine; s: how functions scatter in size, and what the fleet
// leaves open. p is that of the sum of w_k^2 / (f^2 B_k^2 + B_k) over the directions with B_k > 1,
// a chi-square where f is known, in the mean over f: a population with heavier tails than normal ones.
//
// Two campaigns of one machine tell of the same errors, which change between them by `change` times
// their size: B' = (B^-1 + change^2)^-1. The odds of "the same machine" against "another one" are
//
//   Z(B_1 + B_2, w_1 + w_2) / (Z(B_1, w_1) Z(B_2, w_2)),   2 log Z = w' (1 + B)^-1 w - log det(1 + B)
//
// Frames: none. Units: none. Shapes: one entry for each case, the clearest first.
// Failure: none.
// Source: Kass and Raftery, J. Am. Stat. Assoc. 90 (1995), for odds of hypotheses.
// Validity: sizes that scatter about as PopulationFit has it; a machine that was rebuilt between two campaigns is another one.
#pragma once

#include <string>
#include <vector>

#include "fleet/population_fit.h"

namespace abbe::fleet {

struct OddError {
  std::string machine, error;  // "A12", "EBX"
  double times = 0.0;          // of the size that the population has there, rms over directions
  double p_value = 1.0;        // of this case
  double by_chance = 0.0;      // so many cases like it are expected in a fleet where nothing is odd
  bool is_certain() const { return by_chance < 0.01; }
};

// All errors of all machines below p = 0.01 for one case.
std::vector<OddError> OddErrors(const PopulationFit& fit);

struct OddIdentity {
  std::string campaign, said, fits;  // `fits` empty: none of the fleet's machines
  double log10_odds = 0.0;           // of what it fits against what is said
};

struct IdentityOptions {
  double change = 0.2;  // of the errors between two campaigns, in sizes of the population
  double least = 4.0;   // log10 of the odds from which a campaign is named
};

std::vector<OddIdentity> OddIdentities(const PopulationFit& fit,
                                       const std::vector<Campaign>& campaigns,
                                       const IdentityOptions& options);

}  // namespace abbe::fleet
