// Writes the corrected program: words, and the positions that, commanded, reach the wanted ones.
//
// Positions are in the program's units and its G90 or G91, to 1e-6 mm or 1e-7 inch. An increment
// starts from the written, rounded position, so that rounding does not accumulate.
// Source: own; LinuxCNC 2.9 reads it. Validity: words of RS 274/NGC. Shapes: positions X, Y, Z.
// Frames: machine coordinates in, program coordinates of the control out. Units: m in.
// Failure: InputError for a command outside the travels, and for a program of more than
// `most_lines` lines. Memory: the text is handed on in pieces of a megabyte.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>

#include "compensation/corrector.h"
#include "compensation/nc_state.h"

namespace abbe::compensation {

using NcSink = std::function<void(std::string_view)>;

class NcWriter {
 public:
  NcWriter(const Corrector& corrector, const NcState& state, double most_lines, NcSink sink)
      : corrector_(corrector), state_(state), most_lines_(most_lines), sink_(std::move(sink)) {}

  // A word behind a blank, unless it begins the line.
  void Word(std::string_view word);
  // Counts it against `most_lines`.
  void EndLine();
  // G0 or G1 (0 or 10) unless it is in force in the output.
  void Motion(int motion);
  // The code that is in force in the output, ten times; kNoMotion after G80.
  void InForce(int motion) { motion_ = motion; }
  // The path of a move whose end is not known yet stands here; it is written later, between
  // BeginGap and EndGap, in the order of the gaps. Until then nothing is handed on.
  void LeaveGap();
  void BeginGap();
  void EndGap();
  // The three words of a position of the axes; with G53 in machine coordinates.
  void Position(const Eigen::Vector3d& machine, bool is_g53 = false);
  // "A12.5": degrees, to 1e-6.
  void Angle(char letter, std::int64_t millionths);
  // The control stands here.
  void StandAt(const Eigen::Vector3d& machine) { at_ = machine; }
  const Eigen::Vector3d& at() const { return at_; }
  // Hands on what is left.
  void Flush();

  std::size_t positions() const { return positions_; }
  double largest() const { return largest_; }

 private:
  const Corrector& corrector_;
  const NcState& state_;
  double most_lines_;
  NcSink sink_;
  std::string text_;
  struct Gap {
    std::size_t at;  // in text_
    bool is_at_start;
  };
  std::deque<Gap> gaps_;
  std::string behind_;       // the gap that is written
  bool is_at_start_ = true;  // of a line
  int motion_ = kNoMotion;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();
  std::size_t positions_ = 0, lines_ = 0;
  double largest_ = 0.0;
};

}  // namespace abbe::compensation
