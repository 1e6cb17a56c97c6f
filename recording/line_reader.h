// Reads a file line by line through one block of memory.
//
//   LineReader lines("runs/a.csv");
//   while (const auto line = lines.Next()) Parse(*line);  // the view lives until the next call
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace abbe::recording {

class LineReader {
 public:
  // InputError when the file cannot be opened.
  explicit LineReader(const std::filesystem::path& path);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  // The next line without its "\n" or "\r\n", the first one without a byte-order mark; nothing at
  // the end of the file. InputError when a line is longer than the block (1 MiB).
  std::optional<std::string_view> Next();
  // Whether the last line from Next() had a line end, and its number, from 1.
  bool complete() const { return complete_; }
  std::size_t number() const { return number_; }

  // The number of line ends in the whole file, by one pass through it; does not affect Next().
  std::size_t CountLineEnds();

 private:
  std::optional<std::string_view> NextAsItIs();
  std::size_t ReadSome(char* to, std::size_t size);

  std::string name_;
  int file_ = -1;
  std::unique_ptr<char[]> block_;  // uninitialised: only the pages read into are used
  std::size_t begin_ = 0;          // of the unread bytes in block_
  std::size_t end_ = 0;
  std::size_t number_ = 0;
  bool complete_ = true;
};

}  // namespace abbe::recording
