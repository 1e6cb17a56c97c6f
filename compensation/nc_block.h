// One line of an NC program (RS 274, ISO 6983) as words.
//
//   N20 G1 X10.5 F100 (down)    ->  N 20, G 1, X 10.5, F 100, comment "(down)"
//
// Numbers are as written, in the program's units, and finite. Failure: InputError with the line for
// other syntax: parameters, expressions, O words, the block-delete slash, a comment without end.
// Validity: blocks of letter-number words; the meaning of the words is not checked here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace abbe::compensation {

struct NcWord {
  char letter;            // upper case; '(' for a comment
  double value;           // 0 for a comment
  std::string_view text;  // as written
};

// Fills `words`, whose memory is reused from line to line. "%" alone is a block without words.
void ReadBlock(std::string_view line, std::size_t line_number, std::vector<NcWord>& words);

// Ten times the code of a G or M word, which has at most one decimal: 901 for G90.1; -1 if it is
// not such a code.
int CodeTimes10(const NcWord& word);

// Throws InputError "line 12: what".
[[noreturn]] void RefuseLine(std::size_t line_number, const std::string& what);

}  // namespace abbe::compensation
