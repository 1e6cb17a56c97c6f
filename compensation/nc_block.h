// One line of an NC program (RS 274, ISO 6983) as words.
//
//   N20 G1 X10.5 F100 (down)    ->  N 20, G 1, X 10.5, F 100, comment "(down)"
//
// Numbers are as written, in the program's units, and finite. Failure: InputError with the line for
// what is no word: parameters, expressions, O words, the block-delete slash, a comment without end.
// Validity: blocks of letter-number words; nothing here knows what a word means.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace abbe::compensation {

struct NcWord {
  char letter;            // upper case; '(' for a comment, up to and with its end
  double value;           // of a comment 0
  std::string_view text;  // as written
};

// Fills `words`, which keeps its memory from line to line. "%" alone is a block without words.
void ReadBlock(std::string_view line, std::size_t line_number, std::vector<NcWord>& words);

// Ten times the code of a G or M word, which has one decimal at most: 901 of G90.1; -1 for what is
// no such code.
int CodeTimes10(const NcWord& word);

// "line 12: what; advice" as a failure.
[[noreturn]] void RefuseLine(std::size_t line_number, const std::string& what);

}  // namespace abbe::compensation
