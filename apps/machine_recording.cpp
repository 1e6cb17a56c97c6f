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
#include "fusion/near_copy.h"
#include "recording/file_hash.h"
#include "recording/made_on.h"
#include "recording/recording_file.h"

namespace abbe::apps {
namespace {

void Warn(const recording::Recording& recording) {
  if (!recording.warnings.empty()) WorkingLine::Erase();
  for (const std::string& warning : recording.warnings) fmt::print(stderr, "abbe: {}\n", warning);
}

// The first rows, as many as tell what a recording is; no columns where it cannot be read, which its
// reader says.
recording::Recording FirstRowsOf(const std::filesystem::path& path) {
  recording::Recording first;
  try {
    recording::ReadBlocks(path, [&](const recording::Recording& block) {
      if (block.first_row == 0) first = block;
    });
  } catch (const InputError&) {
    first.columns.clear();
  }
  return first;
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

void RefuseNearCopies(const std::vector<std::filesystem::path>& paths) {
  if (paths.size() < 2) return;
  std::vector<recording::Recording> read;
  for (const std::filesystem::path& path : paths) {
    const recording::Recording& now = read.emplace_back(FirstRowsOf(path));
    for (std::size_t i = 0; i + 1 < read.size(); ++i) {
      const auto shared = fusion::SharedNoise(read[i], now);
      if (!shared) continue;
      throw InputError(
          fmt::format("{}: is {} with small changes: its noise, which is new in every measurement, "
                      "is the same (correlation {:.2f}), and would count twice; give one of them",
                      path.string(), paths[i].string(), *shared));
    }
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
