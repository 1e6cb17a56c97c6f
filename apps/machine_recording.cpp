#include "apps/machine_recording.h"

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "recording/recording_file.h"

namespace abbe::apps {

recording::Recording ReadRecordingOf(const machine::Machine& machine,
                                     const std::filesystem::path& path) {
  recording::Recording recording = recording::Read(path);
  for (const std::string& warning : recording.warnings) {
    fmt::print(stderr, "abbe: {}: {}\n", path.string(), warning);
  }
  const std::string made_on = recording.HeaderText("machine").value_or(machine.name);
  if (made_on == machine.name) return recording;
  throw InputError(fmt::format(
      "{}: was recorded on the machine \"{}\", the machine file describes \"{}\"; give the "
      "file of that machine",
      recording.name, made_on, machine.name));
}

}  // namespace abbe::apps
