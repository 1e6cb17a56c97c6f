// A file that a command writes: there whole under its name, or not at all.
//
//   WholeFile file("out/map.toml");
//   file.Append(text);
//   file.Finish();  // without it nothing is left behind
//
// It grows beside its name as NAME.part with the number of the process, and takes the name when it
// is on the disk. A link is followed: what it points to is written, and it stays. What is no plain
// file (a device, a pipe) takes the bytes as they come.
//
// Overwriting is refused, InputError, for a file that the command reads, for one that holds a
// recording, and for another kind of file than is written (told by how both begin); a user who
// wants it says --force. A folder is always refused, and so is a place that cannot be written.
// DeviceError when the disk takes no more ("disk full").
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::recording {

// What the whole program may write over, set once by its main().
struct Overwriting {
  std::vector<std::filesystem::path> inputs;  // that the command reads
  bool force = false;
};
void SetOverwriting(Overwriting overwriting);
bool OverwritingIsForced();

// Refuses a place that no command may write over without --force: an input, a recording. For a
// look before long work; WholeFile looks again.
void RefuseToOverwrite(const std::filesystem::path& path);

class WholeFile {
 public:
  explicit WholeFile(const std::filesystem::path& path);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void Append(std::string_view bytes);
  void Finish();

  // For a library that writes by name: the empty file to fill, instead of Append(). InputError when
  // `path` is a device or a pipe. `kind_of` begins as the content will.
  std::filesystem::path PartToFill(std::string_view kind_of);

 private:
  void Open(std::string_view begin);
  void Remove();

  std::string name_;  // as the user wrote it
  std::filesystem::path target_, part_;
  int file_ = -1;
  bool special_ = false, begun_ = false;
};

// A whole text at once. Missing folders are made.
void WriteWhole(std::string_view text, const std::filesystem::path& path);

}  // namespace abbe::recording
