// The joint estimate of one error map from all runs of a machine, with the kinds of run that
// determine each part of it.
//
//   const FuseReport report = Fuse(mill, runs, {});
//   map::WriteMap(report.map, "out/map.toml");
//   report.functions[4].determined_by;          // {"sweep", "linkage"}; empty: prior only
//   report.contradicting;                       // index of the run that contradicts the others
//
// One estimation, not an average of maps: the functions of the machine, the linkage and its base,
// the head, its target and every offset of a run are free together, under the priors of the machine
// file. The correlation length of the functions is the one with the largest marginal likelihood:
// the probability of the data with all parameters marginalised, to second order at the solution
// (exact for a linear problem, which this nearly is).
//
// A kind of run determines a function when it alone at least halves the function's prior variance
// over the travel. A linkage of unknown link lengths cannot see the isotropic scale, the mean slope
// of EXX, EYY and EZZ: it is calibrated when the data at least halve its prior variance, else
// "prior only".
//
// Units: SI. Failure: InputError for no run, or a map of other functions to be doubted for;
// NumericalError when the estimate does not converge.
// Source: Rasmussen and Williams (2006), 5.4.1 for the marginal likelihood.
#pragma once

#include <string>
#include <vector>

#include "estimation/result.h"
#include "fusion/holdout.h"
#include "fusion/machine_problem.h"
#include "fusion/run_consistency.h"
#include "map/error_map.h"

namespace abbe::fusion {

// Beside the noise of the runs (simulation/doubt.h).
struct Doubt {
  // The map may as well be this one: the difference counts as one standard uncertainty.
  const map::ErrorMap* other = nullptr;
  // m: standard deviation of an unknown displacement, rms over the travels and the components.
  double displacement = 0.0;
};

struct FuseOptions {
  bool choose_smoothness = true;  // else that of the machine file
  int holdout = 0;                // every n-th block of rows of each run; 0: none
  int threads = 0;
  Doubt doubt = {};  // widens the covariance of the map
};

struct FunctionSeen {
  std::string name;                        // "EXX" ... "ECZ", then "A0Z", "B0Z", "C0Y"
  double prior = 0.0;                      // rms standard uncertainty over the travel, m or rad:
  double u = 0.0;                          // of the prior, and with the data
  std::vector<std::string> determined_by;  // kinds of runs, the best first
};

struct ScaleSeen {
  double value = 0.0, u = 0.0, prior = 0.0;  // relative
  bool calibrated = false;
};

struct SmoothnessTried {
  double length;        // m
  double log_evidence;  // against that of the machine file
};

struct FuseReport {
  map::ErrorMap map;
  estimation::Result fit = {};
  std::vector<FunctionSeen> functions = {};
  ScaleSeen scale = {};
  std::vector<SmoothnessTried> smoothness = {};
  double chosen_smoothness = 0.0;  // m
  std::vector<RunConsistency> runs = {};
  int contradicting = -1;              // index into `runs`; -1: none
  std::vector<HeldOut> held_out = {};  // one for each run; empty when not asked for
};

FuseReport Fuse(const machine::Machine& machine, const std::vector<simulation::SimulatedRun>& runs,
                const FuseOptions& options);

}  // namespace abbe::fusion
