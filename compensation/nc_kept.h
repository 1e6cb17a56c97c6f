// Branches by a value that only the control knows, kept for the control.
//
//   NcKept kept(parameters, host);
//   kept.Keep(file, branch);       // O<kept1> if [#<_hal[lamp.ready]> NE [1]] ... O<kept1> endif
//
// A branch that ends with a return makes the rest of its subroutine an `else`, where the `if` has
// no other branch; there parameters of the subroutine may be set.
//
// Known values stand in the conditions as numbers; the others keep their names, which are those of
// the control (NcParameters::IsOfControl). The lines of every branch go to NcHost::TakeKept, which
// refuses what would make a difference behind the branch; a branch in a branch is kept too.
// Failure: InputError with the line for anything else in a branch, and for a condition on a value
// that the corrected program has not. For nc_flow.cpp alone. Source: LinuxCNC 2.9, O codes.
#pragma once

#include <string>
#include <string_view>

#include "compensation/nc_flow.h"
#include "compensation/nc_parameters.h"
#include "compensation/nc_source.h"

namespace abbe::compensation {

class NcKept {
 public:
  NcKept(const NcParameters& parameters, NcHost& host) : parameters_(parameters), host_(host) {}

  // The branches from `first` (its index in file.controls) on; returns the index of the control
  // line up to which everything is written: their end, or that of the subroutine.
  int Keep(const NcFile& file, int first);

 private:
  // The lines from `line` up to the line `end`, of a branch or to the end of the subroutine;
  // whether the last of them is a return.
  bool KeepLines(const NcFile& file, std::size_t line, std::size_t end, bool is_rest);
  static int EndOfSub(const NcFile& file, int control);
  std::string Condition(const NcControlLine& control) const;
  std::string Value(std::string_view text, std::size_t line_number, std::size_t& at) const;

  const NcParameters& parameters_;
  NcHost& host_;
  int count_ = 0;  // of structures, which name them
  int depth_ = 0;  // of those around
};

}  // namespace abbe::compensation
