// A file to which rows are appended while they are measured.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace abbe::recording {

// Creates an empty file and returns its descriptor. InputError if it exists:
// nothing measured is ever overwritten.
int CreateNewFile(const std::filesystem::path& path);

// Throws DeviceError for the current errno, "disk full" in that case; `saved` says what was saved.
[[noreturn]] void ThrowWriteFailure(std::string_view file, std::string_view saved);

// A plain file for appending. The destructor closes it and ignores failures.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);
  // An existing file that goes on behind its first `whole` bytes; what follows them is cut off.
  OutputFile(const std::filesystem::path& path, std::size_t whole);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Returns when the kernel has the bytes. If they do not all fit, removes them back to the
  // last whole line and throws DeviceError.
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
