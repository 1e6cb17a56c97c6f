// The dwells of a sweep (its standstills) and the gap of each probe in each of them: the only part
// of the reduction that reads single rows.
//
// A dwell is a run of consecutive rows of one pass and direction whose position stays within
// `window` of its first row; its first `settle` seconds do not count. Pass 0 and direction 0 are
// outside the sweep; runs with fewer than a quarter of the usual number of rows are turning points,
// not dwells. The gap of a dwell is a Huber-type robust mean. Dwells nearer to each other than
// `window` belong to one station. Dwells in which a channel is frozen are left out.
//
// Frames: none; gaps of probes and positions of axes.
// Units: m, s. Rows with a flag or a NaN are left out and counted; a gap in an unflagged row that
// is negative or above its probe's range is an InputError with file, row, probe, value and range.
// Shapes: five gaps a dwell; dwells in the order of time.
// Failure: InputError for another kind of recording, and as said for a gap.
// Source: robust mean: estimation/robust_mean.h; the rest own.
// Validity: standstills; a sweep read in motion has none.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "probes/head_layout.h"
#include "recording/blocks.h"
#include "recording/recording.h"

namespace abbe::probes {

struct DwellRule {
  double window;  // m
  double settle;  // s
};

struct Dwell {
  double time = 0.0;      // s, mean of its rows
  double duration = 0.0;  // s, from the first to the last of them
  double position = 0.0;  // m, of the swept axis
  int pass = 0;
  int direction = 0;                               // +1, -1: of the approach
  std::size_t station = 0;                         // index into SweepDwells::stations
  std::size_t first_row = 0;                       // of the run
  std::size_t samples = 0;                         // rows that count
  PerProbe<> gap = {};                             // m
  Eigen::Vector3d axes = Eigen::Vector3d::Zero();  // m: [x y z] in the first row
};

struct SampleCounts {
  std::size_t rows = 0;
  std::size_t used = 0;      // in dwells, per row
  std::size_t flagged = 0;   // flag or NaN, or a channel that is frozen
  std::size_t moving = 0;    // between dwells, or settling
  std::size_t outliers = 0;  // single readings that the robust means gave less than full weight
};

// The scatter of single readings within the dwells, pooled over all of them.
struct Scatter {
  double white = 0.0;  // m, standard deviation; 0 when no dwell has two rows
  double lag1 = 0.0;   // correlation of neighbouring readings, without the bias of short dwells
  double dof = 0.0;    // degrees of freedom of `white`
};

// A probe that shows one reading over several dwells (frozen_readings.h); these are left out.
struct FrozenStretch {
  std::size_t probe = 0;
  double reading = 0.0;  // m
  std::size_t dwells = 0;
  Dwell first, last;
};

struct SweepDwells {
  char axis = 'X';
  std::vector<double> stations;  // m, ascending: the mean position of the station's dwells
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  // m: position [x y z] of the first dwell
  std::vector<Dwell> dwells;                        // in the order of time
  PerProbe<Scatter> scatter;
  PerProbe<> step = {};  // m, of the readings (estimation/reading_step.h); 0: none
  std::vector<FrozenStretch> frozen;
  SampleCounts counts;

  // "probe_b shows 100.125 um in 42 dwells, from ... to ..."; empty where nothing is frozen.
  std::string FrozenText() const;
};

// The rule that the recording's header states (`sweep.window_um`, `sweep.settle_s`), else 20 um,
// 0.1 s.
DwellRule DwellRuleOf(const recording::Recording& recording);

// `recording` is of kind sweep; `ranges` are the largest gaps of the probes, m. One pass over the
// rows, holding one block and one dwell in memory; `head` needs no rows of its own.
SweepDwells FindDwells(const recording::Recording& head, const recording::Blocks& blocks,
                       const DwellRule& rule, const PerProbe<>& ranges);
SweepDwells FindDwells(const recording::Recording& recording, const DwellRule& rule,
                       const PerProbe<>& ranges);

}  // namespace abbe::probes
