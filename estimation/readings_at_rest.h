// What the readings of a channel do while nothing moves: white noise, a memory, or a line in time.
//
//   const RestNoise noise = NoiseAtRest(stays);
//   const bool hums = noise.kind == RestKind::kLine;      // mains, vibration
//
// Half of the mean square of the differences of readings k apart is the variance of white noise for
// every k, which a drift hardly enters. Where it is not the same for k of 1 to kLags within 4
// standard deviations, noise with a memory (noise_memory.h) and a sine on white noise are fitted,
// each stay about a mean of its own, and the more probable one is reported; a sine is taken out,
// and what is left asked again, up to four times. Differences that stand out six times are left
// out.
// Units: those of the readings, s, Hz. Shapes: one list of times and readings a stay.
// Failure: none; `freedom` 0 where no stay has two readings.
// Source: J. von Neumann et al., The mean square successive difference, Ann. Math. Statist. 12
// (1941), for the degrees of freedom (2/3 of the differences); Lomb, Astrophys. Space Sci. 39
// (1976).
// Validity: which of both it is, is judged by the first kFewForLines readings. A line without any
// noise was not measured, but planned, and is not reported.
#pragma once

#include <array>
#include <vector>

#include "estimation/noise_memory.h"

namespace abbe::estimation {

enum class RestKind { kWhite, kMemory, kLine };

struct RestNoise {
  RestKind kind = RestKind::kWhite;
  double sd = 0.0;         // of one reading: of its white noise, with the memory; without lines
  double freedom = 0.0;    // degrees of freedom of `sd`
  double scatter = 0.0;    // of the readings about the means of their stays, lines included
  NoiseMemory memory;      // kMemory
  double frequency = 0.0;  // Hz, kLine: of the strongest, one of its aliases
};

inline constexpr std::array kMains{50.0, 60.0};  // Hz
inline constexpr int kLags = 5;
inline constexpr Eigen::Index kFewForLines = 300;

// `stays`: of one channel, in the order of time.
RestNoise NoiseAtRest(const std::vector<Stay>& stays);

}  // namespace abbe::estimation
