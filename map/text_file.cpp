#include "map/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "failure/failure.h"
#include "recording/whole_file.h"

namespace abbe::map {

void WriteWhole(const std::string& text, const std::filesystem::path& path) {
  recording::WriteWhole(text, path);
}

std::string ReadWhole(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) {
    throw InputError(path.string() + ": is a folder; name a file in it");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(
        fmt::format("{}: cannot be read: {}; check the path", path.string(), std::strerror(errno)));
  }
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) {
    throw InputError(fmt::format("{}: cannot be read further; check the disk", path.string()));
  }
  return text;
}

}  // namespace abbe::map
