// The seeds of a statistical test: 1 to ABBE_SEEDS (200); ABBE_SHARD=k/n takes every n-th
// of them from k on.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace abbe {

struct Seeds {
  std::uint64_t first = 1, last = 200, step = 1;
};

inline Seeds SeedsFromEnvironment() {
  Seeds seeds;
  if (const char* count = std::getenv("ABBE_SEEDS")) {
    std::istringstream(count) >> seeds.last;
    if (seeds.last == 0) throw std::runtime_error("ABBE_SEEDS is a number of worlds from 1 on");
  }
  if (const char* shard = std::getenv("ABBE_SHARD")) {
    char slash = 0;
    std::istringstream(shard) >> seeds.first >> slash >> seeds.step;
  }
  return seeds;
}

}  // namespace abbe
