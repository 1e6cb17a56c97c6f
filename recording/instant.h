// Instants in UTC: texts such as "2026-11-21T09:00:00Z" and seconds since 1970.
#pragma once

#include <optional>
#include <string>

namespace abbe::recording {

// Nothing for a text of another form.
std::optional<double> SecondsOf(const std::string& instant);
// The text of an instant, in whole seconds.
std::string InstantText(double seconds);
// The current instant.
std::string UtcNow();

}  // namespace abbe::recording
