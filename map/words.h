// Lines, words and numbers of the text formats that maps are exchanged in.
//
// Failure: InputError that begins with `where`, for a word that is no finite number.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe::map {

std::string_view Trimmed(std::string_view text);

// Between blanks and tabs, or between each `separator`, trimmed.
std::vector<std::string_view> WordsOf(std::string_view text);
std::vector<std::string_view> PartsOf(std::string_view text, char separator);

double NumberOf(std::string_view word, std::string_view where);
std::vector<double> NumbersOf(std::string_view text, std::string_view where);

// Gives a text line by line.
class Lines {
 public:
  Lines(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {}

  // Whether there was another line; `line` is then it, without its end.
  bool Next(std::string_view& line);
  // "file:12", of the line that Next gave last.
  std::string Where() const;

 private:
  std::string_view rest_;
  std::string file_;
  std::size_t number_ = 0;
};

}  // namespace abbe::map
