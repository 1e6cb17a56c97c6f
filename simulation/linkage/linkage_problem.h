// Any set of runs of the linkage as one estimation problem; every fit of such runs uses it.
//
//   estimation::Problem problem = MakeLinkageProblem(simulation, runs, {});
//   problem.Block(problem.Find("graduation")).Hold();        // which blocks are free
//   const estimation::Result result = SolveLinkage(problem);
//   const Eigen::VectorXd x = ParametersOf(result.blocks, runs[0].mounting);
//
// Each run is a source; its rows are the gaps of simulation/linkage/linkage_gaps.h. Runs of one
// mounting share the pose of the base; every mounting has base blocks of its own
// (fusion/calibration.h), with the priors of the machine file. The displacement form has no prior
// for the base position. That is equivalent to differences from a first pose, without the noise of
// that pose in all of them.
// Units: m, rad; rows in standard deviations. Shapes: three rows a pose; ParametersOf as x of
// LinkageSimulation.
// Failure: InputError for no run or a run without poses.
// Source: docs/theory-linkage.md for the models, estimation/problem.h for the fit.
// Validity: every mounting stands still during its runs.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "estimation/noise_memory.h"
#include "estimation/problem.h"
#include "simulation/linkage/linkage_simulation.h"

namespace abbe::simulation {

// Over what the machine file states: the deviation of independent rows, or the memory of those that
// go on from pose to pose (simulation/remembered_noise.h), whitened evenly (linkage_gaps.h).
struct RunNoise {
  double deviation = 1.0;
  std::optional<estimation::NoiseMemory> memory = {};
};

struct LinkageProblemOptions {
  bool displacement = false;
  // Huber threshold in standard deviations; efficiency loss on normal data 0.1 %.
  estimation::RobustLoss loss = estimation::RobustLoss::Huber(3.0);
  std::vector<RunNoise> noise = {};  // of each run; none: as stated
};

// Solves by a few passes from the nominal linkage; where these do not converge, as with a base
// known to some decimetres only, with the trust region. `settled`: remaining distance to the
// solution, in standard uncertainties; with a robust loss few poses do not come much nearer than
// the default. `tolerated`: that of a first look, accepted after the last pass. Failure: that of Problem::Solve.
estimation::Result SolveLinkage(const estimation::Problem& problem, int threads = 0,
                                bool weak_directions = true, double settled = 1e-4,
                                double tolerated = 0.0);

// Not solved; all blocks at the values of `simulation`.
estimation::Problem MakeLinkageProblem(const LinkageSimulation& simulation,
                                       const std::vector<LinkageRun>& runs,
                                       const LinkageProblemOptions& options);

// The mountings of the runs, in the order of first appearance.
std::vector<std::string> MountingsOf(const std::vector<LinkageRun>& runs);

// The parameters of LinkageSimulation for a mounting.
Eigen::VectorXd ParametersOf(const std::vector<estimation::ParameterBlock>& blocks,
                             const std::string& mounting);

// The index of each of these parameters in the free parameters `names`; -1: held.
std::vector<int> ColumnsOf(const std::vector<estimation::ParameterBlock>& blocks,
                           const std::string& mounting, const std::vector<std::string>& names);

}  // namespace abbe::simulation
