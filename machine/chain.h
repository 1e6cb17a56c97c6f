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
//
// The chain also knows which way the control counts. Every position in abbe, of a recording, a
// program, a travel, a table, is the number that the control shows; only here and in
// volumetric_error.h does it become a place of a carriage:
//
//   positive kTool      the number rises as the tool goes towards + against the workpiece (ISO
//                       841); a carriage with the workpiece on it then goes towards -
//   positive kCarriage  the number rises as the carriage itself goes towards +
//
// For an axis that carries the tool both are the same.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace abbe::machine {

enum class Positive { kTool, kCarriage };

// "tool" or "carriage"; empty for any other word.
std::optional<Positive> PositiveNamed(std::string_view word);

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

  // Which way the control counts X, Y and Z. Without it an axis counts as its carriage goes.
  void SetPositive(const std::array<Positive, 3>& positive);
  // Of the words for X, Y and Z, or one word for all three; empty: none was given. InputError for
  // any other text, and for none where an axis carries the workpiece: it names the axis and, by
  // `how`, what to write.
  void ReadPositive(std::string_view words, std::string_view how);
  // "tool tool carriage", of X, Y and Z; an axis that carries the tool counts as the tool goes.
  std::string PositiveText() const;
  // +1 where the carriage goes towards + of M as the number rises, else -1.
  double CarriageSense(char axis) const;
  // +1 where the tool goes towards + of the workpiece as the number rises, else -1.
  double ToolSense(char axis) const;
  Eigen::Vector3d ToolSenses() const;

  // The chain without primes and parentheses: "[w X Y b Z t]".
  std::string Text() const;

 private:
  std::string workpiece_axes_;
  std::string tool_axes_;
  std::array<double, 3> carriage_sense_ = {1.0, 1.0, 1.0};
};

}  // namespace abbe::machine
