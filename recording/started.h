// When a recording began, as its header says: `started`.
// Units: seconds since 1970, UTC. Failure: InputError with file and key for what is no instant.
#pragma once

#include <optional>
#include <string>

#include "recording/recording.h"

namespace abbe::recording {

// Nothing for a header that does not say.
std::optional<double> StartedAt(const Recording& recording);
// The same as "2026-11-21T09:00:00Z"; empty for a header that does not say.
std::string StartedText(const Recording& recording);

}  // namespace abbe::recording
