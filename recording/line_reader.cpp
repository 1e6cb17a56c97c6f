#include "recording/line_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "failure/failure.h"
#include "settings/table_cells.h"

namespace abbe::recording {
namespace {

constexpr std::size_t kBytesAtOnce = std::size_t{1} << 20;

}  // namespace

LineReader::LineReader(const std::filesystem::path& path) : name_(path.string()) {
  file_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) {
    throw InputError(
        fmt::format("{}: cannot be read: {}; check the path", name_, std::strerror(errno)));
  }
  block_ = std::make_unique_for_overwrite<char[]>(kBytesAtOnce);
}

LineReader::~LineReader() { close(file_); }

std::size_t LineReader::ReadSome(char* to, std::size_t size) {
  ssize_t count = 0;
  do {
    count = read(file_, to, size);
  } while (count < 0 && errno == EINTR);
  if (count < 0) {
    throw InputError(fmt::format("{}:{}: cannot be read further: {}; check the disk", name_,
                                 number_ + 1, std::strerror(errno)));
  }
  return count;
}

std::optional<std::string_view> LineReader::Next() {
  auto line = NextAsItIs();
  if (line && number_ == 1) line = settings::WithoutByteOrderMark(*line);
  return line;
}

std::optional<std::string_view> LineReader::NextAsItIs() {
  std::size_t searched = begin_;
  while (true) {
    const void* found = std::memchr(block_.get() + searched, '\n', end_ - searched);
    if (found != nullptr) {
      const char* line = block_.get() + begin_;
      const std::size_t length = static_cast<const char*>(found) - line;
      begin_ += length + 1;
      ++number_;
      return std::string_view(line, length > 0 && line[length - 1] == '\r' ? length - 1 : length);
    }
    // Make room for the rest of the line.
    std::memmove(block_.get(), block_.get() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    searched = end_;
    if (end_ == kBytesAtOnce) {
      throw InputError(fmt::format("{}:{}: this line is longer than 1 MiB; is this a recording?",
                                   name_, number_ + 1));
    }
    const std::size_t count = ReadSome(block_.get() + end_, kBytesAtOnce - end_);
    if (count == 0) break;
    end_ += count;
  }
  if (end_ == 0) return std::nullopt;
  complete_ = false;
  ++number_;
  const std::string_view rest(block_.get(), end_);
  begin_ = end_ = 0;
  return rest;
}

std::size_t LineReader::CountLineEnds() {
  const off_t here = lseek(file_, 0, SEEK_CUR);
  lseek(file_, 0, SEEK_SET);
  std::vector<char> block(kBytesAtOnce);
  std::size_t line_ends = 0;
  while (const std::size_t size = ReadSome(block.data(), block.size())) {
    line_ends += std::count(block.data(), block.data() + size, '\n');
  }
  lseek(file_, here, SEEK_SET);
  return line_ends;
}

}  // namespace abbe::recording
