#include "apps/machine_recording.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "recording/recording_file.h"

namespace abbe::apps {
namespace {

void Warn(const std::filesystem::path& path, const recording::Recording& recording) {
  for (const std::string& warning : recording.warnings) {
    fmt::print(stderr, "abbe: {}: {}\n", path.string(), warning);
  }
}

void RefuseOtherMachine(const machine::Machine& machine, const recording::Recording& recording) {
  const std::string made_on = recording.HeaderText("machine").value_or(machine.name);
  if (made_on == machine.name) return;
  throw InputError(fmt::format(
      "{}: was recorded on the machine \"{}\", the machine file describes \"{}\"; give the "
      "file of that machine",
      recording.name, made_on, machine.name));
}

}  // namespace

recording::Recording ReadRecordingOf(const machine::Machine& machine,
                                     const std::filesystem::path& path) {
  recording::Recording recording = recording::Read(path);
  Warn(path, recording);
  RefuseOtherMachine(machine, recording);
  return recording;
}

recording::Recording ReadHeadOf(const machine::Machine& machine,
                                const std::filesystem::path& path) {
  recording::Recording head = recording::ReadHead(path);
  RefuseOtherMachine(machine, head);
  return head;
}

recording::Blocks BlocksOf(const std::filesystem::path& path) {
  return [path, warned = std::make_shared<bool>(false)](const recording::UseBlock& use) {
    recording::ReadBlocks(path, [&](const recording::Recording& block) {
      if (!*warned) Warn(path, block);
      use(block);
    });
    *warned = true;
  };
}

}  // namespace abbe::apps
