// One error map of a machine, estimated jointly from all its runs, and for each error the kinds of
// run that determine it.
//
//   const FuseReport report = Fuse(mill, runs, {});     // runs simulated on UnknownMachine(mill)
//   map::WriteMap(report.map, "out/map.toml");
//   report.functions[4].determined_by;          // {"sweep", "linkage"}; empty: prior only
//   report.contradicting;                       // index of the run that contradicts the others
//
// One estimation, not an average of maps: the functions of the machine, the linkage and its base,
// the head, its target and every offset of a run are free together, under the priors of the machine
// file. How large and how smooth the errors are, how noisy each run is and by how much the two
// directions of an axis differ is estimated too (population_estimate.h, reversals.h); where a
// function is rougher than the knots of its spline can follow, the runs are simulated on finer
// ones; so they are where a run of places can show waves of the positioning errors.
//
// Frames: those of map/error_map.h. Shapes: lists in the order of the runs or of the 21 errors.
// Source: Rasmussen and Williams (2006), 5.4.1 for the marginal likelihood; Birge, Phys. Rev. 40
// (1932) for uncertainties under a contradiction.
// Units: SI.
// Failure: InputError for no run; NumericalError when the estimate does not converge.
// Validity: to first order at the estimate; errors that do not change between the runs.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "estimation/noise_memory.h"
#include "estimation/result.h"
#include "fusion/holdout.h"
#include "fusion/machine_problem.h"
#include "fusion/map_doubt.h"
#include "fusion/place_scatter.h"
#include "fusion/population_estimate.h"
#include "fusion/reversals.h"
#include "fusion/run_consistency.h"
#include "fusion/run_suspect.h"
#include "fusion/seen_errors.h"
#include "map/error_map.h"

namespace abbe::fusion {

struct FuseOptions {
  bool choose_smoothness = true;  // and sizes and noise; else those of the machine file
  // The same runs on a machine with other knots; empty: the knots stay as they are.
  std::function<std::vector<simulation::SimulatedRun>(const machine::VolumetricModel&)> runs_on =
      {};
  // The knots of the model on which the runs are simulated, m apart; none: KnotsOf(machine).
  std::optional<std::array<double, machine::kAxes>> knots = {};
  int holdout = 0;  // every n-th block of rows of each run; 0: none
  int threads = 0;
  Doubt doubt = {};  // widens the covariance of the map
  // When the runs were made, s since 1970, and how warm it was: the map then has a state
  // (map/map_state.h) with the instruments. 0: it has none.
  double measured = 0.0;
  std::vector<map::Warmth> sensors = {};
};

struct FuseReport {
  map::ErrorMap map;
  estimation::Result fit = {};
  std::vector<FunctionSeen> functions = {};
  ScaleSeen scale = {};
  std::vector<Statement> statements = {};  // of the machine file; empty where they are not judged
  std::vector<double> noise = {};          // of each run: its white noise over the stated one
  // What goes on from row to row in each run, over the stated noise (row_memory.h).
  std::vector<std::optional<estimation::NoiseMemory>> memory = {};
  std::vector<Reversal> reversals = {};  // the map is the mean of both directions
  double chosen_smoothness = 0.0;        // m: of all functions together
  std::vector<std::string> kinds = {};   // of each run
  std::vector<std::string> notes = {};   // what was taken out of the readings of which run
  std::vector<RunConsistency> runs = {};
  int contradicting = -1;              // index into `runs`; -1: none
  double widened = 1.0;                // all uncertainties for it, by its Birge ratio
  Suspect suspect = Suspect::kNone;    // of that contradiction
  std::vector<int> may_be_wrong = {};  // runs (run_consistency.h)
  std::vector<double> follows = {};    // of each run: correlation of its residuals from row to row
  // The axis whose positions scatter in each run; the uncertainty of the map contains it.
  std::vector<PlaceScatter> scatter = {};
  std::vector<HeldOut> held_out = {};  // one for each run; empty when not asked for
  // What the runs tell of the parameters of the map's model, without a prior of these; empty where
  // sizes and smoothness are not chosen.
  Quadratic seen = {};
};

// `runs`: simulated on one model, whose knots `runs_on` may change.
FuseReport Fuse(const machine::Machine& machine, const std::vector<simulation::SimulatedRun>& runs,
                const FuseOptions& options);

}  // namespace abbe::fusion
