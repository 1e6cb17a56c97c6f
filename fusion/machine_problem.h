// Any set of runs on one machine as one estimation problem.
//
//   estimation::Problem problem = MakeMachineProblem(mill, model, prior, runs);
//
// `noise`: that of each run, over what is stated; empty: as stated. Blocks: the functions of the
// machine and its squareness, then the blocks of the runs, shared by name.
// Units: SI. Shapes: one source a run.
// Sources: one for each run in their order, then "smoothness", the prior of the functions.
// Failure: InputError for no run.
// Validity: that of the simulations of the runs.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "estimation/problem.h"
#include "fusion/machine_prior.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

inline constexpr std::string_view kSmoothnessSource = "smoothness";

// Not solved; functions start at the values of `model`.
estimation::Problem MakeMachineProblem(const machine::Machine& machine,
                                       const machine::VolumetricModel& model,
                                       const MachinePrior& prior,
                                       const std::vector<simulation::SimulatedRun>& runs,
                                       const std::vector<double>& noise = {});

// The estimates of all entries of these blocks, in their order.
Eigen::VectorXd ValuesFound(const estimation::Result& fit,
                            const std::vector<estimation::ParameterBlock>& blocks);

// Where all entries of these blocks begin, in their order.
Eigen::VectorXd NominalValues(const std::vector<estimation::ParameterBlock>& blocks);

// Where the entries of these blocks stand among the names of all columns.
std::vector<int> ColumnsOf(const std::vector<std::string>& names,
                           const std::vector<estimation::ParameterBlock>& blocks);

// Whether a block may return in a later run: of the machine, an instrument, or a mounting with a
// name; not a base without one, nor what a run has for itself.
bool OutlivesRuns(const estimation::ParameterBlock& block,
                  const std::vector<simulation::SimulatedRun>& runs);

}  // namespace abbe::fusion
