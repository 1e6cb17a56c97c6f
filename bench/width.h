// Holds the kernels of a benchmark to a width of vectors: with ABBE_WIDTH=AVX2 in the environment
// they are those of a processor that has nothing wider. Included once in a program.
#pragma once

#include <hwy/targets.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace abbe::bench {

inline bool HoldWidth() {
  const char* const wanted = std::getenv("ABBE_WIDTH");
  if (wanted == nullptr) return false;
  for (auto left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const auto target = left & -left;  // a lower bit is a wider target
    if (std::string_view(hwy::TargetName(target)) != wanted) continue;
    hwy::DisableTargets(target - 1);
    return true;
  }
  std::fprintf(stderr, "ABBE_WIDTH=%s: this processor has no such vectors\n", wanted);
  std::exit(2);
}

inline const bool kHeld = HoldWidth();

}  // namespace abbe::bench
