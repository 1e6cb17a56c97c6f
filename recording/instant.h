// Instants, in UTC unless the text states a zone ("T14:00:00+05:00"), and seconds since 1970. A date
// alone is its first second.
#pragma once

#include <optional>
#include <string>

namespace abbe::recording {

// Nothing for a text of another form, and for a date or time that does not exist (30 February).
std::optional<double> SecondsOf(const std::string& instant);
// The text of an instant, in whole seconds.
std::string InstantText(double seconds);
// The current instant.
std::string UtcNow();

}  // namespace abbe::recording
