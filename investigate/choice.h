// The run to make next: of all that could be made, the one that is expected to tell most a minute
// of what is the matter.
//
//   const Choice choice = Choose({campaign, recordings, now, place, costs, about, made, 0, records});
//   choice.weighed[0].text;  // "sweep X over its travel, there and back, with the head"
//   choice.weighed[0].bits_per_minute();
//
// The runs are those of diagnosis/run_catalogue.h whose instrument is at hand, simulated on the
// machine as the diagnosis fitted it, before any run on one drawn from the machine file.
// Units: bits, minutes, s. Shapes: weighed runs, the best first.
// Failure: that of LinearRuns. InputError where no run can be made.
// Source: expected_information.h.
// Validity: one run ahead: runs that tell only together are not seen.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "investigate/cost.h"
#include "recording/recording.h"
#include "simulation/planned_paths.h"

namespace abbe::investigate {

struct Situation {
  const diagnosis::Campaign& campaign;  // of the recordings; without runs at first
  const std::vector<recording::Recording>& recordings;
  const diagnosis::Diagnosis* now;  // null before the first run
  Place place;                      // what is on the machine
  const Costs& costs;
  simulation::PathAbout about;  // of a run that begins now
  // The simulation that promises may be wrong: each time that a run of this text was made before
  // halves what it promises, and each run since anything was settled halves what all promise.
  std::vector<std::string> made;
  int stalled = 0;
  // Whether a path can be recorded at all.
  std::function<bool(const recording::Recording& path)> records;
};

struct WeighedRun {
  std::string text;
  Minutes minutes;
  double bits = 0.0;  // expected
  recording::Recording path = {};

  double bits_per_minute() const { return bits / minutes.total(); }
};

struct Probable {
  std::string name;
  double probability;
};

struct Choice {
  std::vector<WeighedRun> weighed = {};
  double entropy = 0.0;               // bits, before the run
  std::vector<Probable> worlds = {};  // the most probable, groups as one
  // Probability that nothing is the matter among all that any of these runs could show.
  double nothing = 0.0;
  std::vector<std::string> never_shown = {};  // causes that none of these runs shows
};

// All that could be made, weighed.
Choice Choose(const Situation& situation);

}  // namespace abbe::investigate
