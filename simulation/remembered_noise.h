// A run whose noise goes on from one row to the next.
//
//   const SimulatedRun remembers = WithMemory(run, trace.time, noise);
//
// `run` is whitened as if its rows were independent. Here the rows of each channel (of a place in
// space: x, y, z) are taken to be noise with a memory, in units of that one, the same for all
// channels, and whitened once more (estimation/noise_memory.h): evidence then counts what is
// independent in them. Shapes: `times` of the rows of the run in their order, some residuals for
// each (x, y, z of one pose, then of the next).
// Units: s.
// Failure: none.
// Source: Kalman, J. Basic Engineering 82 (1960) for the filter.
// Validity: channels that turn into each other slowly against the memory, as the Cholesky factors
// of a pose do.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "estimation/noise_memory.h"
#include "estimation/residual.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

// Chi-square then counts independent noise.
SimulatedRun WithMemory(const SimulatedRun& run, const Eigen::VectorXd& times,
                        const estimation::NoiseMemory& noise);

// A residual alone.
std::shared_ptr<const estimation::Residual> WithMemory(
    std::shared_ptr<const estimation::Residual> residual, const Eigen::VectorXd& times,
    const estimation::NoiseMemory& noise);

// What is left of a run, for estimation::FitMemory: each channel for itself.
std::vector<estimation::Stay> ChannelsOf(const Eigen::VectorXd& left, const Eigen::VectorXd& times);

}  // namespace abbe::simulation
