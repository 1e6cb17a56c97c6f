// Correction of an NC program by an error map: each move is commanded so that the tool reaches the
// programmed position.
//
//   NcSource source("part.ngc", text);
//   const NcCounts counts = CorrectProgram(corrector, options, source, write);
//
// Loops, branches, subroutines, parameters and expressions are written out, canned cycles as their
// moves. G0 keeps its end point; G1 is divided into lines no longer than limits.length, G2 and G3
// into chords within limits.chord, written as G1. Every corrected line gives X, Y and Z, because
// the errors of one axis move all three (nc_writer.h). All other words, line numbers and comments
// stay on the first line of their block; M0 M1 M2 M30 M60, which act after the move, are on the
// last.
//
// Supported: docs/correct.md; anything else is refused with its line and a way out.
// Modes that a program does not set before its first move are assumed to be G21, G90 and, for arcs,
// G17, and listed in NcCounts::assumed, because the control may be in other modes. G0 before the
// place of all three axes is known, and G28 or G30 to a place that is not known, are copied and
// listed in NcCounts::uncorrected.
// Frames: program coordinates + offsets (nc_offsets.h) = axis positions of the map. Units: m.
// Failure: InputError with the line, also while the position of the machine is unknown, for a
// command outside the travels, for a program that was corrected already, and for a move that would
// become more than kMostLines lines.
// Source: RS 274/NGC (NIST IR 6556); LinuxCNC 2.9. Validity: rigid tools; errors at standstill.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "compensation/corrector.h"
#include "compensation/nc_meaning.h"
#include "compensation/nc_path.h"
#include "compensation/nc_source.h"
#include "compensation/nc_tables.h"
#include "compensation/nc_writer.h"

namespace abbe::compensation {

struct NcOptions {
  PathLimits limits;
  Eigen::Vector3d work_offset = Eigen::Vector3d::Zero();  // G54, unless tables has parameters
  std::optional<Eigen::Vector3d> start;  // position at the start, program coordinates
  NcTables tables = {};
  // The tool point of a tool whose length offset is 0; tools with G43 need it.
  std::optional<Eigen::Vector3d> p_TQ_gauge = {};
  std::optional<bool> deletes_blocks = {};  // whether the control leaves out blocks with /
  NcAllowed allowed = {};
  std::string mark = {};        // comment at the head of the program: MarkOf; empty: none
  bool corrects_again = false;  // a program that carries a mark
  std::size_t most_steps = 20'000'000;
  double most_lines = 2e8;
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
  std::size_t copied_moves = 0;           // moves that are not corrected
  std::vector<NcAssumption> uncorrected;  // why, and the first line
  bool has_end = false;                   // M2, M30 or a % after the first line
};

// "(corrected by abbe with the map NAME of DATE)", by which a corrected program is known; characters
// that no comment takes become _. An empty date is left out.
std::string MarkOf(const std::string& map, const std::string& date);

// Hands the corrected program to `write` in pieces.
NcCounts CorrectProgram(const Corrector& corrector, const NcOptions& options, NcSource& source,
                        const NcSink& write);

}  // namespace abbe::compensation
