#include "apps/machine_recording.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "apps/working_line.h"
#include "failure/failure.h"
#include "recording/file_hash.h"
#include "recording/made_on.h"
#include "recording/recording_file.h"

namespace abbe::apps {
namespace {

void Warn(const recording::Recording& recording) {
  if (!recording.warnings.empty()) WorkingLine::Erase();
  for (const std::string& warning : recording.warnings) fmt::print(stderr, "abbe: {}\n", warning);
}

}  // namespace

void RefuseTwice(const std::vector<std::filesystem::path>& recordings) {
  struct Seen {
    std::filesystem::path path;
    std::string hash;  // empty: not needed yet
  };
  std::map<std::uintmax_t, std::vector<Seen>> seen;  // by size
  for (const std::filesystem::path& path : recordings) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) continue;  // what it is says its reader
    Seen now{path, {}};
    for (Seen& other : seen[size]) {
      if (std::filesystem::equivalent(path, other.path, error)) {
        throw InputError(fmt::format(
            "{}: is given twice, and its rows would count twice; give it once", path.string()));
      }
      if (now.hash.empty()) now.hash = recording::Sha256OfFile(path);
      if (other.hash.empty()) other.hash = recording::Sha256OfFile(other.path);
      if (now.hash != other.hash) continue;
      throw InputError(
          fmt::format("{}: is a copy of {}, and its rows would count twice; give one of them",
                      path.string(), other.path.string()));
    }
    seen[size].push_back(std::move(now));
  }
}

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
