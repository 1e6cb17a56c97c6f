#include "recording/started.h"

#include <fmt/format.h>

#include "recording/instant.h"

namespace abbe::recording {

std::optional<double> StartedAt(const Recording& recording) {
  const auto text = recording.HeaderText("started");
  if (!text) return std::nullopt;
  if (const auto seconds = SecondsOf(*text)) return seconds;
  throw InputError(fmt::format("{}: started = {} is no time; write it as 2026-11-21T09:00:00Z",
                               recording.name, *text));
}

std::string StartedText(const Recording& recording) {
  constexpr std::size_t kDate = 10;  // characters of a date alone, which stays one
  const auto seconds = StartedAt(recording);
  if (!seconds) return "";
  const std::string text = *recording.HeaderText("started");
  return text.size() == kDate ? text : InstantText(*seconds);
}

}  // namespace abbe::recording
