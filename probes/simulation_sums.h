// The sums of the errors over a part of the draws of published_simulations.h, compiled for each width
// of the processor's vectors.
//
// Units: m and rad. Failure: none. Source and validity: published_simulations.h.
#pragma once

#include <algorithm>
#include <array>

#include "probes/published_simulations.h"

namespace abbe::probes {

// Draws are made and evaluated in blocks that fit the first-level cache.
inline constexpr std::size_t kBlock = 256;
// Sums are kept in lanes, so that their order is fixed and the compiler can use vector
// instructions.
inline constexpr std::size_t kLanes = 8;

struct Sums {
  std::array<std::array<double, kLanes>, kPublishedComponents> worst{}, sum{}, squares{};

  void Add(const Sums& other) {
    for (std::size_t c = 0; c < kPublishedComponents; ++c) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        worst[c][lane] = std::max(worst[c][lane], other.worst[c][lane]);
        sum[c][lane] += other.sum[c][lane];
        squares[c][lane] += other.squares[c][lane];
      }
    }
  }
};

// Sums over the draws from `first` on, which is a multiple of kBlock, to before `end`.
Sums SumsOf(const SimulationOptions& options, std::uint64_t first, std::uint64_t end);

}  // namespace abbe::probes
