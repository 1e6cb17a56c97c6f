// The output file of a command: it appears complete under its name, or not at all.
//
//   WholeFile file("out/map.toml");
//   file.Append(text);
//   file.Finish();  // without it nothing is left behind
//
// It is written as NAME.PID.part in the same folder and renamed when it is on the disk. A symbolic
// link is kept and its target written. A device or a pipe receives the bytes directly.
//
// Overwriting is refused with InputError for an input of the command, for a recording,
// and for a file of a kind other than the one written (judged by how both begin), unless
// the user gives --force. A folder and a place without write permission are always
// refused. DeviceError when the disk is full.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::recording {

// The overwriting rules of the program, set once by its main().
struct Overwriting {
  std::vector<std::filesystem::path> inputs;  // of the command
  bool force = false;
};
// Not thread-safe: call it before any file is written.
void SetOverwriting(Overwriting overwriting);
bool OverwritingIsForced();

// InputError if `path` is an input or a recording and --force was not given. For a check
// before long work; WholeFile checks again.
void RefuseToOverwrite(const std::filesystem::path& path);

class WholeFile {
 public:
  explicit WholeFile(const std::filesystem::path& path);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void Append(std::string_view bytes);
  void Finish();

  // The path of an empty file to be filled instead of Append(), for a library that opens files by
  // name. InputError when `path` is a device or a pipe. `kind_of`: how the content will begin.
  std::filesystem::path PartToFill(std::string_view kind_of);

 private:
  void Open(std::string_view begin);
  void Remove();

  std::string name_;  // as the user wrote it
  std::filesystem::path target_, part_;
  int file_ = -1;
  bool special_ = false, begun_ = false;
};

// Writes a text as such a file. Missing folders are created.
void WriteWhole(std::string_view text, const std::filesystem::path& path);

}  // namespace abbe::recording
