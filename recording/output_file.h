// A file that takes rows while they are measured, with failures that say what to do.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace abbe::recording {

// Creates an empty file, for its owner to write. An existing one is InputError: nothing measured is
// ever overwritten. Returns its descriptor.
int CreateNewFile(const std::filesystem::path& path);

// DeviceError for the current errno: "disk full" where it is that, and what was saved.
[[noreturn]] void ThrowWriteFailure(std::string_view file, std::string_view saved);

// A plain file that takes bytes at its end. Closes itself, without a word on failure.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Returns when the bytes are with the kernel. When not all of them can be taken, takes them back
  // up to the last whole line and throws DeviceError.
  void Append(std::string_view bytes);
  // Returns when the bytes are on the disk.
  void Sync();
  void Close();

 private:
  std::string name_;
  int file_ = -1;
  std::size_t size_ = 0;
};

}  // namespace abbe::recording
