// Correction of an NC program by an error map: each move is commanded so that the tool reaches the
// programmed position.
//
//   NcCorrection correction(corrector, options);
//   correction.Take("G2 X20 Y0 I5 J0 F100", out);      // appends the corrected lines to `out`
//
// G0 keeps its end point; G1 is divided into lines no longer than limits.length, G2 and G3 into
// chords within limits.chord, written as G1. Every corrected line gives X, Y and Z, because the
// errors of one axis move all three, in the program's own units and G90 or G91, to 1e-6 mm or 1e-7
// inch. All other words, line numbers and comments stay on the first line of their block; M0 M1 M2
// M30 M60, which act after the move, are on the last.
//
// Supported: G0 G1 G2 G3 (I J K or R, helices), G4, G17 G18 G19, G20 G21, G40, G49, G54, G61, G64,
// G80, G90 G91, G90.1 G91.1, G94, G97; M0 to M9, M30, M48, M49, M60; F N S T. Anything else is
// refused with its line: cutter compensation, tool length offsets, G28, G53, G92, canned cycles,
// rotary axes, subprograms, parameters.
// Modes that a program does not set before its first move are assumed to be G21, G90 and, for arcs,
// G17, and listed in NcCounts::assumed, because the control may be in other modes.
// Frames: program coordinates + work_offset = axis positions of the map. Units: m.
// Failure: InputError with the line, also while the position of the machine is unknown, for a
// command outside the travels, and for a move that would become more than kMostLines lines.
// Source: RS 274/NGC (NIST IR 6556). Validity: rigid tool of one length; errors at standstill.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compensation/corrector.h"
#include "compensation/nc_block.h"
#include "compensation/nc_path.h"

namespace abbe::compensation {

struct NcOptions {
  PathLimits limits;
  Eigen::Vector3d work_offset = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> start;  // position at the start, program coordinates
};

struct NcAssumption {
  std::string what;  // "millimetres (G21)"
  std::size_t line;  // of the first move that depends on it
};

struct NcCounts {
  std::size_t lines = 0, moves = 0,
              corrected = 0;  // lines read; moves; lines written for the moves
  double largest = 0.0;       // largest correction, m
  std::vector<NcAssumption> assumed;
  bool has_end = false;  // M2, M30 or a % after the first line
};

class NcCorrection {
 public:
  NcCorrection(const Corrector& corrector, const NcOptions& options);

  // Corrects the next line (without its end) and appends the result to `out`.
  void Take(std::string_view line, std::string& out);
  // Call after the last line: InputError for a truncated program, which begins with % and has no
  // end.
  void Finish() const;
  const NcCounts& counts() const { return counts_; }

 private:
  // The words of a block that are not copied.
  struct Block {
    std::array<std::optional<double>, 3> axes, centre;  // as written
    std::optional<double> radius;
    bool dwells = false, has_p = false, is_move = false;
  };

  Block Understand();
  void TakeG(const NcWord& word, Block& block);
  void RefuseLooseWords(const Block& block);
  Eigen::Vector3d Target(const Block& block);
  Arc ArcOf(const Block& block) const;
  void MustReach(const Eigen::Vector3d& wanted) const;
  void Divide(const Block& block, const Eigen::Vector3d& target);
  void Assume();
  void Move(const Block& block, std::string& out);
  void WritePoint(const Eigen::Vector3d& wanted, std::string& out);

  const Corrector& corrector_;
  NcOptions options_;
  NcCounts counts_;
  std::vector<NcWord> words_;
  std::vector<Eigen::Vector3d> points_;
  // The modal state.
  int motion_ = -1, plane_ = 17;
  bool is_inch_ = false, is_relative_ = false, centre_is_absolute_ = false;
  bool is_open_ = false;  // began with %
  struct {
    bool units = false, distances = false, plane = false;
  } says_;  // modes that the program has set, or that are assumed
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();  // the programmed position
  std::array<bool, 3> is_known_{};
  int motion_out_ = -1;                            // active in the output
  Eigen::Vector3d out_ = Eigen::Vector3d::Zero();  // last position in the output
};

}  // namespace abbe::compensation
