#include "recording/made_on.h"

#include <fmt/format.h>

#include "failure/failure.h"

namespace abbe::recording {

void RefuseOtherMachine(const Recording& recording, const std::string& machine) {
  const auto named = recording.HeaderText("machine");
  if (!named || named == machine) return;
  throw InputError(
      fmt::format("{}: was recorded on the machine \"{}\", the machine file describes \"{}\"; give "
                  "the file of that machine",
                  recording.name, *named, machine));
}

void RefuseOtherKind(const Recording& recording, std::string_view kind, std::string_view why) {
  if (recording.Kind() == kind) return;
  throw InputError(fmt::format("{}: kind is \"{}\", not \"{}\"; {}", recording.name,
                               recording.Kind(), kind, why));
}

}  // namespace abbe::recording
