// Feeds files to a fuzzing target, without a fuzzer:
//
//   fuzz_replay TARGET FILE_OR_FOLDER...             every file, in the order of the names
//   fuzz_replay TARGET --cuts 400 FILE_OR_FOLDER...  every file, cut at every byte; larger ones at
//                                                    so many places, evenly
//
// Ends with 0 when each was read or refused as it should be, with 2 when there is no such target or
// no file. A broken promise, a crash, a file that takes over a minute ends it by a signal; the file
// that did it is the last one named on standard error.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "fuzz/contract.h"

#define ABBE_TARGET(name)      \
  namespace abbe::fuzz::name { \
  void Read(Bytes bytes);      \
  }
#include "fuzz_targets.inc"
#undef ABBE_TARGET

namespace {

namespace fs = std::filesystem;

struct Target {
  const char* name;
  abbe::fuzz::Reader read;
};

#define ABBE_TARGET(name) Target{#name, abbe::fuzz::name::Read},
constexpr std::array kTargets{
#include "fuzz_targets.inc"
};
#undef ABBE_TARGET

constexpr unsigned kSeconds = 60;

std::vector<fs::path> FilesOf(int count, char** names) {
  std::vector<fs::path> files;
  for (int i = 0; i < count; ++i) {
    if (!fs::is_directory(names[i])) {
      files.emplace_back(names[i]);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(names[i])) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

int Refuse(const std::string& name) {
  std::fprintf(stderr, "no target \"%s\" or no file; the targets:", name.c_str());
  for (const Target& each : kTargets) std::fprintf(stderr, " %s", each.name);
  std::fprintf(stderr, "\n");
  return 2;
}

// The file whole, or its beginnings: `cuts` at most.
std::size_t Replay(const Target& target, const std::vector<char>& bytes, std::size_t cuts) {
  const std::span all(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  alarm(kSeconds);
  if (cuts == 0) {
    abbe::fuzz::HoldContract(target.read, all);
    return 1;
  }
  const std::size_t count = std::min(cuts, bytes.size());
  for (std::size_t i = 0; i < count; ++i) {
    abbe::fuzz::HoldContract(target.read, all.first(i * bytes.size() / count));
  }
  return count;
}

}  // namespace

int main(int count, char** words) {
  const std::string name = count > 1 ? words[1] : "";
  const bool is_cut = count > 3 && std::string(words[2]) == "--cuts";
  const std::size_t cuts = is_cut ? std::strtoul(words[3], nullptr, 10) : 0;
  const int first = is_cut ? 4 : 2;
  const auto target =
      std::ranges::find_if(kTargets, [&](const Target& each) { return each.name == name; });
  const auto files = FilesOf(std::max(0, count - first), words + first);
  if (target == kTargets.end() || files.empty() || (is_cut && cuts == 0)) return Refuse(name);
  std::size_t inputs = 0;
  for (const fs::path& file : files) {
    std::fprintf(stderr, "%s\n", file.c_str());
    std::ifstream stream(file, std::ios::binary);
    inputs += Replay(*target, {std::istreambuf_iterator<char>(stream), {}}, cuts);
  }
  std::printf("%zu %s read or refused\n", inputs, is_cut ? "beginnings of files" : "files");
  return 0;
}
