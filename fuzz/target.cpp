#include "fuzz/target.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace abbe::fuzz {

// Without close-on-exec: a reader may look at its file from a child process.
InputFile::InputFile(Bytes bytes) : file_(memfd_create("input", 0)) {
  Require(file_ >= 0, "a file in memory can be made");
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t size = write(file_, bytes.data() + done, bytes.size() - done);
    Require(size > 0, "a file in memory can be written");
    done += size;
  }
  path_ = "/proc/self/fd/" + std::to_string(file_);
}

InputFile::~InputFile() { close(file_); }

std::string ProjectText(const std::filesystem::path& name) {
  std::ifstream file(std::filesystem::path(ABBE_SOURCE_DIR) / name, std::ios::binary);
  Require(file.good(), "the project's own files can be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

void Require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

}  // namespace abbe::fuzz
