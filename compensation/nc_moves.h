// The moves of one block: where they go, and the corrected lines for them.
//
// For nc_correction.cpp alone. Frames and units: nc_state.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "compensation/corrector.h"
#include "compensation/nc_beside.h"
#include "compensation/nc_correction.h"
#include "compensation/nc_cycles.h"
#include "compensation/nc_meaning.h"
#include "compensation/nc_state.h"
#include "compensation/nc_writer.h"

namespace abbe::compensation {

class NcMoves {
 public:
  NcMoves(const Corrector& corrector, const NcOptions& options, NcState& state, NcWriter& writer,
          NcCounts& counts)
      : corrector_(corrector), options_(options), state_(state), writer_(writer), counts_(counts) {}

  // The move of a block whose modes are in force.
  void Move(const NcBlock& block, const NcMeaning& meaning, std::size_t line_number);
  // G28 (home 0) or G30 (1).
  void GoHome(const NcBlock& block, const NcMeaning& meaning, int home, std::size_t line_number);
  // G40, or the end of the program: writes the moves beside the path that are open.
  void EndBeside();
  // InputError if the axes cannot stand there; program coordinates.
  void MustReach(const Eigen::Vector3d& wanted) const;

 private:
  Eigen::Vector3d Target(const NcMeaning& meaning);
  Arc ArcOf(const NcMeaning& meaning) const;
  NcCycle CycleOf(const NcMeaning& meaning);
  void Divide(const NcPiece& move);
  void Assume(bool needs_plane);
  void Approach(const NcBlock& block, const NcMeaning& meaning);
  void MoveAlong(const NcBlock& block, const NcMeaning& meaning, const Eigen::Vector3d& target);
  void MoveBeside(const NcBlock& block, const NcMeaning& meaning, const Eigen::Vector3d& target);
  void FillGap(const std::vector<NcPiece>& pieces);
  void WriteCycle(const NcBlock& block, const NcMeaning& meaning);
  void CopyUncorrected(const NcBlock& block, bool is_rapid, const char* why);
  void WriteWords(const NcBlock& block);
  void WriteStops(const NcBlock& block);
  void WritePath(int motion);
  void WriteAngles(std::size_t index);
  void WriteInMachine(const NcMeaning& meaning);
  void TakeAngles(const NcMeaning& meaning);
  [[noreturn]] void Refuse(const std::string& what) const { RefuseLine(line_number_, what); }

  const Corrector& corrector_;
  const NcOptions& options_;
  NcState& state_;
  NcWriter& writer_;
  NcCounts& counts_;
  NcBeside beside_;
  std::size_t line_number_ = 0;
  std::vector<Eigen::Vector3d> points_;    // program coordinates
  std::array<NcMeaning::Value, 3> turns_;  // where A, B, C turn in this block
  std::array<double, 3> turn_from_{};
  double inverse_feed_ = 0.0;
  struct {
    bool units = false, distances = false, plane = false, retract = false;
  } assumed_;
};

}  // namespace abbe::compensation
