// What the words of one block mean: its codes by group, its values, what it must be refused for.
//
//   const NcMeaning meaning = MeaningOf(block, 12, allowed);
//   meaning.motion;                    // 20 in a block with G2: ten times the code
//
// Units: values as written. Failure: InputError with the line and a way out for a code or word that
// cannot be corrected, two codes of one group, a value that is known only at the control where it
// would move the tool. Source: RS 274/NGC (NIST IR 6556), 3.4 and table 4; LinuxCNC 2.9.
// Validity: modes from earlier blocks are not known here.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "compensation/nc_block.h"
#include "compensation/nc_state.h"

namespace abbe::compensation {

struct NcMeaning {
  using Value = std::optional<double>;

  int motion = kNoMotion;    // G0 to G3, G80 (800), cycles
  int nonmodal = kNoMotion;  // G4 G10 G28 G28.1 G30 G30.1 G92 to G92.3
  bool is_g53 = false;
  std::vector<int> modes;                     // the other G codes, ten times
  std::array<Value, 3> axes, centre, rotary;  // XYZ, IJK, ABC
  Value feed, radius, p, q, l, h, d, polar_radius, polar_angle;
  bool is_end = false;      // M2, M30
  int context = kNoMotion;  // M70 to M73
  bool changes_tool = false;
  bool is_beside = false;  // G41 to G42.1
  // Whether anything but comments and a line number stands in the block.
  bool acts = false;

  bool HasMode(int code) const {
    return std::find(modes.begin(), modes.end(), code) != modes.end();
  }
  // X, Y, Z or polar.
  bool HasAxes() const { return axes[0] || axes[1] || axes[2] || polar_radius || polar_angle; }
  // A, B or C.
  bool HasRotary() const { return rotary[0] || rotary[1] || rotary[2]; }
  // I, J or K.
  bool HasCentre() const { return centre[0] || centre[1] || centre[2]; }
};

// The M codes of a machine's own, which alone may be copied.
inline constexpr int kFirstOfUser = 100, kLastOfUser = 999;

struct NcAllowed {
  std::set<int> copied;  // M codes that are kept because they do not move the machine
  bool rotary = false;   // A, B, C: axes that carry the workpiece
};

// What a block says; modes that are in force from earlier blocks play no part.
NcMeaning MeaningOf(const NcBlock& block, std::size_t line_number, const NcAllowed& allowed);

// Whether nothing that follows depends on whether the block acted: messages, a dwell, stops, the
// end of the program, outputs and waits for inputs, M codes of `copied`.
bool LeavesNothing(const NcBlock& block, const std::set<int>& copied);

// Whether a word of a block with G41 to G42.1 belongs to them.
bool IsOfBeside(const NcWord& word);

// The word as it stands in the corrected program: as written, or with the value of its expression.
std::string TextOf(const NcWord& word, std::size_t line_number);

// Keeps the words of modal groups in `state`.
void KeepModalWords(const NcBlock& block, std::size_t line_number, NcState& state);

}  // namespace abbe::compensation
