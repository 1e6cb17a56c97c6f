// The causes of bad and uncertain samples as bits of a recording's column `flags`, and back.
#pragma once

#include <cstdint>

#include "hal/sample.h"

namespace abbe::hal {

// The bit that a cause sets; 0 for kNone.
std::uint32_t FlagOf(Cause cause);

// A cause that explains the bits of a row, the most serious one first; kNone for 0.
Cause CauseOf(std::uint32_t flags);

}  // namespace abbe::hal
