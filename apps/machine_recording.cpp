#include "apps/machine_recording.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "recording/made_on.h"
#include "recording/recording_file.h"

namespace abbe::apps {
namespace {

void Warn(const recording::Recording& recording) {
  for (const std::string& warning : recording.warnings) fmt::print(stderr, "abbe: {}\n", warning);
}

}  // namespace

recording::Recording ReadWithWarnings(const std::filesystem::path& path) {
  recording::Recording recording = recording::Read(path);
  Warn(recording);
  return recording;
}

recording::Recording ReadRecordingOf(const machine::Machine& machine,
                                     const std::filesystem::path& path) {
  recording::Recording recording = ReadWithWarnings(path);
  recording::RefuseOtherMachine(recording, machine.name);
  return recording;
}

recording::Recording ReadHeadOf(const machine::Machine& machine,
                                const std::filesystem::path& path) {
  recording::Recording head = recording::ReadHead(path);
  recording::RefuseOtherMachine(head, machine.name);
  return head;
}

recording::Blocks BlocksOf(const std::filesystem::path& path) {
  return [path, warned = std::make_shared<bool>(false)](const recording::UseBlock& use) {
    recording::ReadBlocks(path, [&](const recording::Recording& block) {
      if (!*warned) Warn(block);
      use(block);
    });
    *warned = true;
  };
}

simulation::RunSource SourceAt(const machine::Machine& machine, const std::filesystem::path& path) {
  return {ReadHeadOf(machine, path), BlocksOf(path),
          [machine, path] { return ReadRecordingOf(machine, path); }};
}

}  // namespace abbe::apps
