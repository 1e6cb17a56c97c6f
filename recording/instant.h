// Instants as files write them, "2026-11-21T09:00:00Z", as seconds since 1970.
#pragma once

#include <optional>
#include <string>

namespace abbe::recording {

// Nothing for a text that is no such instant.
std::optional<double> SecondsOf(const std::string& instant);
std::string InstantText(double seconds);
// The present one.
std::string UtcNow();

}  // namespace abbe::recording
