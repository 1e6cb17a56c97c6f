// A run together with its simulation, ready to be fitted: what the estimator in fusion/ takes.
//
//   for (const SimulatedRun& run : runs) AddToProblem(run);      // fusion/machine_problem.h
//
// The residual is whitened: measured minus simulated reading, of standard deviation 1. Its x are
// the entries of `blocks`, one block after the other. Blocks are shared by name: the functions of
// the machine by all runs, the probes by all sweeps, the target by the sweeps of one mounting.
// A new kind of run is a new file that makes one of these.
//
// A run of more rows than a fit wants to see gives a sample of them as its residual, and
// `condense`: called with the x that fits the sample, it makes one residual of all rows.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "estimation/residual.h"
#include "estimation/robust_loss.h"

namespace abbe::simulation {

// Beyond so many standard deviations a row of a run with single readings pulls no more; costs
// normal data 0.1 %.
inline constexpr double kPullsNoMore = 3.0;

struct SimulatedRun {
  std::string name;  // of the recording
  std::string kind;  // "sweep", "linkage", "reference", "length", "plate"
  std::vector<estimation::ParameterBlock> blocks;
  std::shared_ptr<const estimation::Residual> residual;
  estimation::RobustLoss loss = estimation::RobustLoss::None();
  std::function<std::shared_ptr<const estimation::Residual>(const Eigen::VectorXd& x)> condense =
      {};
};

}  // namespace abbe::simulation
