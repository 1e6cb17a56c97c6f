// Values in a line of an NC program: numbers, parameters, expressions and functions.
//
//   NcCursor cursor("[#<depth> / 2 + sin[30]]", 12, parameters);
//   cursor.Value();
//
// Operators from the strongest: ** | * / MOD | + - | EQ NE GT GE LT LE | AND OR XOR, from the left.
// Functions: ABS ACOS ASIN ATAN[y]/[x] COS EXISTS[#<name>] EXP FIX FUP LN ROUND SIN SQRT TAN.
// EQ and its kin compare to 1e-6. Units: as written; angles in degrees.
// Failure: InputError with the line for other syntax, a name without a value, a division by zero,
// a root or a logarithm that does not exist, brackets nested more than 64 deep.
// Source: RS 274/NGC (NIST IR 6556), 3.3.2; LinuxCNC 2.9 (the comparisons).
#pragma once

#include <string>
#include <string_view>

#include "compensation/nc_parameters.h"

namespace abbe::compensation {

class NcCursor {
 public:
  NcCursor(std::string_view text, std::size_t line_number, const NcParameters& parameters)
      : text_(text), line_number_(line_number), parameters_(parameters) {}

  // The next character behind blanks, in upper case; 0 at the end.
  char Peek();
  // Takes it if it is `c`.
  bool Take(char c);
  // Takes a word of letters if it is `word` (upper case), with blanks or without.
  bool TakeWord(std::string_view word);
  // Whether a value can begin here.
  bool IsAtValue();
  // Takes a number, a parameter, an expression or a function.
  double Value();
  // After #: the name of <...>, or the number of anything else as text.
  struct Parameter {
    std::string name;  // empty: numbered
    int number = 0;
  };
  Parameter ParameterName();

  std::size_t at() const { return at_; }
  // What was not taken.
  std::string_view Rest() const { return text_.substr(at_); }
  // Takes `count` characters.
  void Skip(std::size_t count) { at_ += count; }
  // InputError with the line.
  [[noreturn]] void Refuse(const std::string& what) const;

 private:
  struct Deeper;
  double Number();
  double Expression();
  double Operand(int weakest);
  double Function();
  double Read(const Parameter& parameter) const;
  int TakeOperator(int weakest);

  std::string_view text_;
  std::size_t line_number_, at_ = 0;
  int depth_ = 0;
  const NcParameters& parameters_;
};

}  // namespace abbe::compensation
