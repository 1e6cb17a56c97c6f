// Any set of runs of the linkage as one estimation problem: the one way in which runs are fitted.
//
//   estimation::Problem problem = MakeLinkageProblem(simulation, runs, {});
//   problem.Block(problem.Find("graduation")).Hold();        // which blocks are free
//   const estimation::Result result = SolveLinkage(problem);
//   const Eigen::VectorXd x = ParametersOf(result.blocks, runs[0].mounting);
//
// Each run is a source; its rows are the gaps of simulation/linkage/linkage_gaps.h. Runs of one mounting
// share the pose of the base; every mounting has base blocks of its own (fusion/calibration.h),
// with the priors of the machine file. The displacement form knows nothing of the base position
// beforehand: its prior is left out. That is the same as to use differences from a first pose, but
// without the noise of that pose in every difference.
// Failure: InputError for no run or a run without poses.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/problem.h"
#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {

struct LinkageProblemOptions {
  bool displacement = false;
  // Beyond 3 standard deviations a row pulls no more than there; costs normal data 0.1 %.
  estimation::RobustLoss loss = estimation::RobustLoss::Huber(3.0);
};

// A ten-thousandth of a standard uncertainty is settled, if nothing is said: a robust loss gets no
// nearer on few poses.
// Nearly always a few passes from the nominal linkage do; where they do not, as with a base that is
// known to some decimetres only, the trust region goes before them. Failure: that of
// Problem::Solve.
estimation::Result SolveLinkage(const estimation::Problem& problem, int threads = 0,
                                bool weak_directions = true, double settled = 1e-4);

estimation::Problem MakeLinkageProblem(const simulation::LinkageSimulation& simulation,
                                       const std::vector<simulation::LinkageRun>& runs,
                                       const LinkageProblemOptions& options);

// In the order of first appearance.
std::vector<std::string> MountingsOf(const std::vector<simulation::LinkageRun>& runs);

// x of LinkageSimulation for a mounting.
Eigen::VectorXd ParametersOf(const std::vector<estimation::ParameterBlock>& blocks,
                             const std::string& mounting);

// Where the entries of that x are among the free parameters `names`; -1: held.
std::vector<int> ColumnsOf(const std::vector<estimation::ParameterBlock>& blocks,
                           const std::string& mounting, const std::vector<std::string>& names);

}  // namespace abbe::fusion
