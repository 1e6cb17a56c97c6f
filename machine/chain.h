// The order of a machine's axes from the workpiece over the bed to the tool, as ISO 10791-6 writes
// it.
//
//   [w X' Y' b Z (C) t]    the table carries X on Y, the column carries Z, a spindle C holds the
//   tool
//
// Between `w` and `b` stand the axes that move the workpiece (ISO marks them with a prime, which
// may be left out), between `b` and `t` those that move the tool. An axis in parentheses is not
// numerically controlled and is no part of the geometry here. An axis X, Y or Z that does not stand
// in the chain is none of this machine's: [w X b t] is a table. At least one must.
#pragma once

#include <string>
#include <string_view>

namespace abbe::machine {

class Chain {
 public:
  // `text` as above; blanks between the letters are optional. InputError says which letter is wrong
  // and what was expected.
  static Chain Parse(std::string_view text);

  // The axes 'X', 'Y', 'Z' that move the workpiece, from the workpiece to the bed, and those that
  // move the tool, from the bed to the tool: [w X Y b Z t] has "XY" and "Z".
  const std::string& workpiece_axes() const { return workpiece_axes_; }
  const std::string& tool_axes() const { return tool_axes_; }

  // Whether the axis moves the target, which sits in the place of the workpiece; if not, it moves
  // the probe head, which sits in the place of the tool, or is not there. `axis` is 'X', 'Y' or
  // 'Z', else InputError.
  bool CarriesTarget(char axis) const;

  // The axes that move the carriage of `axis`: those between the bed and it, and itself. For
  // [w X Y b Z t]: X is moved by "YX", Z by "Z".
  std::string Movers(char axis) const;

  // The chain without primes and parentheses: "[w X Y b Z t]".
  std::string Text() const;

 private:
  std::string workpiece_axes_;
  std::string tool_axes_;
};

}  // namespace abbe::machine
