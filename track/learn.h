// The walk of a machine, and the lags with which it follows its sensors, from a history of short
// tests, by marginal likelihood.
//
//   std::vector<HistoryStep> history;
//   history.push_back({followed, runs, began});            // of each recording, in their order
//   const Learned learned = Learn(tracked, history, {true});
//   tracked = learned.map;                                 // before all tests
//
// The walk keeps its shape, that of [drift] or, without one, a twentieth of [population] a day; its
// size is one factor of all. Lags that the machine file states stay.
// Units: SI. Shapes: one entry a recording. Failure: InputError for fewer than 4 recordings, and as
// TrackedMap.
// Source: gaussian.h; maximum.h.
// Validity: the tests are linearised once, about the map with the walk it began with; the factor is
// then taken as known.
#pragma once

#include <vector>

#include "track/tracked_map.h"

namespace abbe::track {

struct HistoryStep {
  std::vector<Conditions> followed;  // up to the test
  std::vector<simulation::SimulatedRun> runs;
  double began = 0.0;
};

struct Learned {
  double factor = 1.0;       // of the walk
  std::vector<double> lags;  // s, of each sensor
  double gain = 0.0;         // of the log likelihood, against the factor and the lags before
  TrackedMap map;            // before the first test, with what was learned
};

// `lags`: of each sensor, whether it is to be learned.
Learned Learn(const TrackedMap& start, const std::vector<HistoryStep>& history,
              const std::vector<bool>& lags);

}  // namespace abbe::track
