// Lines and numbers of the text formats of maps.
//
// Units: none; numbers as they stand.
// Failure: InputError that begins with `where`, for a word that is not a finite number.
// Validity: ASCII texts with lines that end in LF or CR LF.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "settings/words.h"

namespace abbe::map {

using settings::PartsOf;
using settings::Trimmed;
using settings::WordsOf;

// Numbers up to kLargest only, with a decimal point.
inline constexpr double kLargest = 1e15;
// One number.
double NumberOf(std::string_view word, std::string_view where);
// All the numbers of a line.
std::vector<double> NumbersOf(std::string_view text, std::string_view where);

// Reads a text line by line.
class Lines {
 public:
  Lines(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {}

  // Sets `line` to the next line, without its end; false after the last.
  bool Next(std::string_view& line);
  // "file:12" for the last line from Next().
  std::string Where() const;

 private:
  std::string_view rest_;
  std::string file_;
  std::size_t number_ = 0;
};

}  // namespace abbe::map
