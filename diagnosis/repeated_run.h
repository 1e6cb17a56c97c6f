// A recorded run made again, with one thing changed.
//
//   const AgainAbout about{.machine = "demo-mill", .started = tomorrow};
//   const recording::Recording slower = AtFeed(Again(run, about), 0.2);
//
// The rows are those of the recording, readings included (planned_run.h replaces them). The header
// keeps what a simulation asks for: kind, axis, the rule of the dwells, and the mounting unless
// another one is named. Units: those of a recording.
#pragma once

#include <string>

#include "recording/recording.h"
#include "simulation/sweep/sweep_run.h"

namespace abbe::diagnosis {

struct AgainAbout {
  std::string machine;
  double started = 0.0;       // s since 1970
  std::string mounting = {};  // of the target, or of the linkage's base; empty: as it was
  simulation::SweepMounting mounted = {};  // of head and target, where `mounting` is another one
};
recording::Recording Again(const recording::Recording& run, const AgainAbout& about);

// From its end to its beginning, on the same way.
recording::Recording TurnedRound(recording::Recording run);

// So many times as fast.
recording::Recording AtFeed(recording::Recording run, double times);

recording::Recording Warmer(recording::Recording run, double kelvin);

// Whether most of its rows are of a motion.
bool Moves(const recording::Recording& run);

}  // namespace abbe::diagnosis
