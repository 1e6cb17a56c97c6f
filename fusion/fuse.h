// The joint estimate of one error map from all runs of a machine, with the kinds of run that
// determine each part of it.
//
//   const FuseReport report = Fuse(mill, runs, {});     // runs simulated on UnknownMachine(mill)
//   map::WriteMap(report.map, "out/map.toml");
//   report.functions[4].determined_by;          // {"sweep", "linkage"}; empty: prior only
//   report.contradicting;                       // index of the run that contradicts the others
//
// One estimation, not an average of maps: the functions of the machine, the linkage and its base,
// the head, its target and every offset of a run are free together, under the priors of the machine
// file. How large and how smooth the errors are, and how noisy each run is, is estimated too
// (population_estimate.h); where a function is rougher than the knots of its spline can follow,
// the runs are simulated on finer ones.
//
// Source: Rasmussen and Williams (2006), 5.4.1 for the marginal likelihood.
// Units: SI. Failure: InputError for no run; NumericalError when the estimate does not converge.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "estimation/result.h"
#include "fusion/holdout.h"
#include "fusion/machine_problem.h"
#include "fusion/map_doubt.h"
#include "fusion/population_estimate.h"
#include "fusion/run_consistency.h"
#include "fusion/seen_errors.h"
#include "map/error_map.h"

namespace abbe::fusion {

// What explains a contradiction: the run agrees with the others once it has this of its own. kNone:
// nothing of these.
enum class Suspect { kNone, kMounting, kInstrument };

struct FuseOptions {
  bool choose_smoothness = true;  // and sizes and noise; else those of the machine file
  // The same runs on a machine with other knots; empty: the knots stay as they are.
  std::function<std::vector<simulation::SimulatedRun>(const machine::VolumetricModel&)> runs_on =
      {};
  int holdout = 0;  // every n-th block of rows of each run; 0: none
  int threads = 0;
  Doubt doubt = {};  // widens the covariance of the map
};

struct FuseReport {
  map::ErrorMap map;
  estimation::Result fit = {};
  std::vector<FunctionSeen> functions = {};
  ScaleSeen scale = {};
  std::vector<Statement> statements = {};  // of the machine file; empty where they are not judged
  std::vector<double> noise = {};          // of each run, over what is stated
  double chosen_smoothness = 0.0;          // m: of all functions together
  std::vector<std::string> kinds = {};     // of each run
  std::vector<RunConsistency> runs = {};
  int contradicting = -1;              // index into `runs`; -1: none
  Suspect suspect = Suspect::kNone;    // of that contradiction
  std::vector<double> follows = {};    // correlation of what each run leaves from row to row
  std::vector<HeldOut> held_out = {};  // one for each run; empty when not asked for
};

FuseReport Fuse(const machine::Machine& machine, const std::vector<simulation::SimulatedRun>& runs,
                const FuseOptions& options);

}  // namespace abbe::fusion
