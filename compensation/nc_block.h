// One line of an NC program (RS 274, ISO 6983) as words with values.
//
//   N20 G1 X[#1 * 2] F100 (down)    ->  N 20, G 1, X 7, F 100, comment "(down)"
//
// Numbers are in the program's units and finite, or kRuntime (nc_parameters.h). Parameters that the
// line sets (#1 = 3) are values to be set after it. Failure: InputError with the line for other
// syntax, a comment without end.
// Validity: the meaning of the words is not checked here; O words are those of nc_source.h.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compensation/nc_expression.h"
#include "compensation/nc_parameters.h"

namespace abbe::compensation {

struct NcWord {
  char letter;             // upper case; '(' for a comment; '@' '^' polar, '$' spindle
  double value;            // 0 for a comment
  std::string_view text;   // as written
  bool is_literal = true;  // a number as written, not a parameter or an expression
};

struct NcSetting {
  NcCursor::Parameter parameter;
  double value;
};

struct NcBlock {
  bool is_deletable = false;  // begins with /
  std::vector<NcWord> words;
  std::vector<NcSetting> settings;
};

// Fills `block`, whose memory is reused from line to line. "%" alone is a block without words.
void ReadBlock(std::string_view line, std::size_t line_number, const NcParameters& parameters,
               NcBlock& block);

// Ten times the code of a G or M word, which has at most one decimal: 901 for G90.1; -1 if it is
// not such a code.
int CodeTimes10(const NcWord& word);

// Throws InputError "line 12: what".
[[noreturn]] void RefuseLine(std::size_t line_number, const std::string& what);

}  // namespace abbe::compensation
