// What the words of a block set on the control: modes, the tool with its length, offsets, homes.
//
// For nc_correction.cpp alone. Frames and units: nc_state.h. Failure: InputError with the line for
// what only the control knows.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "compensation/corrector.h"
#include "compensation/nc_correction.h"
#include "compensation/nc_meaning.h"
#include "compensation/nc_state.h"
#include "compensation/nc_writer.h"

namespace abbe::compensation {

class NcSetup {
 public:
  // `corrector` gets the point of the tool.
  NcSetup(Corrector& corrector, const NcOptions& options, NcState& state, const NcWriter& writer)
      : corrector_(corrector), options_(options), state_(state), writer_(writer) {}

  void TakeModes(const NcBlock& block, const NcMeaning& meaning, std::size_t line_number);
  // G10, G92 and its kin, G28.1 and G30.1; other blocks change nothing.
  void TakeOffsets(const NcMeaning& meaning, std::size_t line_number);

 private:
  void TakeMode(int code, const NcMeaning& meaning);
  const NcTool& ToolOf(double number);
  void TakeTool(const NcBlock& block, const NcMeaning& meaning);
  void TakeToolLength(int code, const NcMeaning& meaning);
  // G40 to G42.1.
  void TakeBeside(int code, const NcMeaning& meaning);
  // InputError for what must not change between G41 or G42 and G40.
  void MustStayBeside(const NcMeaning& meaning) const;
  bool Changes(int code) const;
  void TakeG92(int code, const NcMeaning& meaning);
  void TakeG10(const NcMeaning& meaning);
  void TakeHome(int home);
  // The offsets of the A, B, C that are given changed; where `is_here`, their places are the given.
  void TakeAngles(const NcMeaning& meaning, bool is_here);
  // Lengths of a block that sets offsets; not a number where none is given.
  Eigen::Vector3d Given(const NcMeaning& meaning) const;
  void MustKnow(const NcMeaning& meaning) const;
  [[noreturn]] void Refuse(const std::string& what) const { RefuseLine(line_number_, what); }

  Corrector& corrector_;
  const NcOptions& options_;
  NcState& state_;
  const NcWriter& writer_;
  std::size_t line_number_ = 0;
};

}  // namespace abbe::compensation
