// The seeds of a statistical test: 1 to ABBE_SEEDS (200); ABBE_SHARD=k/n takes every n-th
// of them from k on.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <sstream>

namespace abbe {

struct Seeds {
  std::uint64_t first = 1, last = 200, step = 1;
};

inline Seeds SeedsFromEnvironment() {
  Seeds seeds;
  if (const char* count = std::getenv("ABBE_SEEDS")) seeds.last = std::strtoull(count, nullptr, 10);
  if (const char* shard = std::getenv("ABBE_SHARD")) {
    char slash = 0;
    std::istringstream(shard) >> seeds.first >> slash >> seeds.step;
  }
  return seeds;
}

}  // namespace abbe
