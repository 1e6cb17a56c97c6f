// The kinematic chain of a machine: its axes from the workpiece over the bed to the tool, in the
// notation of ISO 10791-6.
//
//   [w X' Y' b Z (C) t]    X on Y carries the workpiece, Z carries the tool, a spindle C holds it
//
// The axes between `w` and `b` move the workpiece (ISO marks them with a prime, which may be left
// out), those between `b` and `t` move the tool. An axis in parentheses is not numerically
// controlled and is ignored here. An axis X, Y or Z that is not in the chain does not exist, as Y
// and Z of the table [w X b t]. At least one must exist.
//
// The chain also defines the sign of positions. Every position in abbe (in a recording, a program,
// a travel, a table) is the number that the control shows. Only this header and volumetric_error.h
// turn it into the displacement of a carriage:
//
//   Positive::kTool      the number rises as the tool moves towards + relative to the workpiece
//                        (ISO 841); a carriage with the workpiece on it then moves towards -
//   Positive::kCarriage  the number rises as the carriage itself moves towards +
//
// For an axis that carries the tool both are the same.
// Frames: axes are those of M, the frame of the bed.
// Failure: InputError for a text that is no chain, for an axis other than X, Y, Z, and where the
// sign of a position is needed and not stated.
// Source: ISO 10791-6:2014 for the notation, ISO 841 for the signs; not checked against their
// texts.
// Validity: linear axes X, Y, Z, each once; a rotary axis only in parentheses, held still.
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
  // `text` as above; blanks between the letters are optional. InputError names the wrong letter and
  // the expected form.
  static Chain Parse(std::string_view text);

  // The axes 'X', 'Y', 'Z' that move the workpiece, from the workpiece to the bed, and those that
  // move the tool, from the bed to the tool: [w X Y b Z t] has "XY" and "Z".
  const std::string& workpiece_axes() const { return workpiece_axes_; }
  const std::string& tool_axes() const { return tool_axes_; }

  // Whether the axis carries the target (mounted in place of the workpiece). Else it carries the
  // probe head (in place of the tool), or the machine has no such axis. InputError unless `axis` is
  // 'X', 'Y' or 'Z'.
  bool CarriesTarget(char axis) const;

  // The axes that move the carriage of `axis`: all from the bed up to the axis itself. For [w X Y b
  // Z t]: X is moved by "YX", Z by "Z".
  std::string Movers(char axis) const;

  // The sign of the positions of X, Y and Z; Positive::kCarriage unless set.
  void SetPositive(const std::array<Positive, 3>& positive);
  // The signs from text: three words for X, Y and Z, or one for all; none where no axis carries the
  // workpiece. InputError for any other text; where words are missing it names the axis and quotes
  // `how`, which says where to write them.
  void ReadPositive(std::string_view words, std::string_view how);
  // "tool tool carriage", for X, Y and Z; "tool" for an axis that carries the tool.
  std::string PositiveText() const;
  // +1 if the carriage moves towards + in M as the number rises, else -1.
  double CarriageSense(char axis) const;
  // +1 if the tool moves towards + relative to the workpiece as the number rises, else -1.
  double ToolSense(char axis) const;
  // ToolSense of X, Y and Z.
  Eigen::Vector3d ToolSenses() const;

  // The chain without primes and parentheses: "[w X Y b Z t]".
  std::string Text() const;

 private:
  std::string workpiece_axes_;
  std::string tool_axes_;
  std::array<double, 3> carriage_sense_ = {1.0, 1.0, 1.0};
};

}  // namespace abbe::machine
