// An NC program, corrected: its moves are commanded where the machine's errors bring them to the
// places that the program means.
//
//   NcCorrection correction(corrector, options);
//   correction.Take("G2 X20 Y0 I5 J0 F100", out);      // appends the corrected lines to `out`
//
// G0 keeps its end point; G1 is split into lines no longer than limits.length, G2 and G3 into
// chords within limits.chord, written as G1. Every corrected line gives X, Y and Z, because the
// errors of one axis move all three, in the program's own units and G90 or G91, to 1e-6 mm or
// 1e-7 inch. All other words, line numbers and comments stay on the first line of their block;
// M0 M1 M2 M30 M60, which act after the move, on the last.
//
// Supported: G0 G1 G2 G3 (I J K or R, helices), G4, G17 G18 G19, G20 G21, G40, G49, G54, G61, G64,
// G80, G90 G91, G90.1 G91.1, G94, G97; M0 to M9, M30, M48, M49, M60; F N S T. Anything else is
// refused with its line: cutter compensation, tool length offsets, G28, G53, G92, canned cycles,
// rotary axes, subprograms, parameters.
// What a program does not say before its first move is taken as G21, G90 and, for arcs, G17, and
// counted (NcCounts::assumed): its control may be set otherwise.
// Frames: program coordinates + work_offset = axis positions of the map. Units: m.
// Failure: InputError with the line, also where the machine's place is not yet known, where a
// command lies outside the travels, and where a move would become more than kMostLines lines.
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
  std::optional<Eigen::Vector3d> start;  // where the axes stand at the start, program coordinates
};

struct NcAssumption {
  std::string what;  // "millimetres (G21)"
  std::size_t line;  // of the first move that it matters for
};

struct NcCounts {
  std::size_t lines = 0, moves = 0,
              corrected = 0;  // read; moves among them; lines written for them
  double largest = 0.0;       // correction, m
  std::vector<NcAssumption> assumed;
  bool has_end = false;  // M2, M30 or a % after the first line
};

class NcCorrection {
 public:
  NcCorrection(const Corrector& corrector, const NcOptions& options);

  // The next line, without its end.
  void Take(std::string_view line, std::string& out);
  // After the last line: InputError for a program that begins with % and has no end, for it was
  // cut.
  void Finish() const;
  const NcCounts& counts() const { return counts_; }

 private:
  // What a block says besides words that pass through.
  struct Asked {
    std::array<std::optional<double>, 3> axes, centre;  // as written
    std::optional<double> radius;
    bool dwells = false, has_p = false, is_move = false;
  };

  Asked Understand();
  void TakeG(const NcWord& word, Asked& asked);
  void RefuseLooseWords(const Asked& asked);
  Eigen::Vector3d Target(const Asked& asked);
  Arc ArcOf(const Asked& asked) const;
  void MustReach(const Eigen::Vector3d& wanted) const;
  void Divide(const Asked& asked, const Eigen::Vector3d& target);
  void Assume();
  void Move(const Asked& asked, std::string& out);
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
  } says_;  // what the program has said, or is taken to say
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();  // that the program means
  std::array<bool, 3> is_known_{};
  int motion_out_ = -1;                            // in force in what was written
  Eigen::Vector3d out_ = Eigen::Vector3d::Zero();  // what was written last
};

}  // namespace abbe::compensation
