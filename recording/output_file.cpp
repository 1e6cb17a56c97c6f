#include "recording/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "failure/failure.h"

namespace abbe::recording {

int CreateNewFile(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_EXCL, 0666);
  if (file >= 0) return file;
  if (errno == EEXIST) {
    throw InputError(
        fmt::format("{}: exists already, and nothing recorded is overwritten; choose another name",
                    path.string()));
  }
  throw InputError(fmt::format("{}: cannot be created: {}; choose a folder that can be written",
                               path.string(), std::strerror(errno)));
}

void ThrowWriteFailure(std::string_view file, std::string_view saved) {
  const int error = errno;
  if (error == ENOSPC || error == EDQUOT || error == EFBIG) {
    throw DeviceError(fmt::format("{}: disk full; {}; free some space and try again", file, saved));
  }
  throw DeviceError(fmt::format("{}: cannot be written: {}; {}; check the disk", file,
                                std::strerror(error), saved));
}

OutputFile::OutputFile(const std::filesystem::path& path)
    : name_(path.string()), file_(CreateNewFile(path)) {}

OutputFile::OutputFile(const std::filesystem::path& path, std::size_t whole)
    : name_(path.string()),
      file_(open(path.c_str(), O_WRONLY | O_CLOEXEC | O_APPEND)),
      size_(whole) {
  if (file_ < 0) {
    throw InputError(fmt::format("{}: cannot be written: {}; choose a file that can be", name_,
                                 std::strerror(errno)));
  }
  if (ftruncate(file_, static_cast<off_t>(whole)) != 0) {
    ThrowWriteFailure(name_, "what it has stays as it is");
  }
}

OutputFile::~OutputFile() {
  if (file_ >= 0) close(file_);
}

void OutputFile::Append(std::string_view bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = write(file_, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int error = errno;
      const std::size_t line_end = bytes.substr(0, written).rfind('\n');
      size_ += line_end == std::string_view::npos ? 0 : line_end + 1;
      if (ftruncate(file_, size_) != 0) {
        // Part of a line remains at the end; readers drop it.
      }
      errno = error;
      ThrowWriteFailure(name_, "all rows that fitted are saved");
    }
    written += count;
  }
  size_ += bytes.size();
}

void OutputFile::Sync() {
  // EINVAL: a device without synchronisation, which has the bytes already.
  if (fdatasync(file_) != 0 && errno != EINVAL && errno != EROFS) {
    ThrowWriteFailure(name_, "the last rows may be lost");
  }
}

void OutputFile::Close() {
  const int file = file_;
  file_ = -1;
  if (file >= 0 && close(file) != 0) ThrowWriteFailure(name_, "the last rows may be lost");
}

}  // namespace abbe::recording
