// The equations of circles in one form of their reversals, and their solution: what
// fusion/circle_causes.h averages over forms.
//
//   const std::vector<standards::Signature> table = CausesOf(run, options, form);
//   const CircleFit fit = SolveCircles({CentredEquations(runs, 0, options, form)}, table, options, {1e-7, {}});
//
// Units: SI. Shapes: a row for each point of a run.
// Failure: NumericalError where the fit fails.
// Source: fusion/circle_causes.h. For use within fusion/ only.
// Validity: errors small against the radius.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "estimation/noise_memory.h"
#include "estimation/result.h"
#include "fusion/circle_causes.h"
#include "paths/circle_run.h"
#include "standards/circle_signatures.h"

namespace abbe::fusion {

// What may happen at a reversal: how backlash is taken up, and on which way of the first and the
// second axis, m; the form of spikes. In m of each axis, 0 where it is of no matter: the spikes whose
// form is not that of the table, the backlash whose way and the spikes whose width are not known
// exactly.
struct ReversalForm {
  standards::TakenUp how = standards::TakenUp::kAtOnce;
  std::array<double, 2> way{};
  standards::SpikeForm spike = {};
  std::array<double, 2> spike_size{}, wound_up{}, spread{};
};

std::string CauseName(const standards::Signature& cause);  // "backlash.X"
// The table of signatures without the centre of the set-up.
std::vector<standards::Signature> CausesOf(const paths::CircleRun& run, const CauseOptions& options,
                                           const ReversalForm& form);

// Radial deviations of a run, and their derivatives with respect to the centre, each cause, the
// harmonics of smooth errors, the errors of the instrument, what spikes do beside their form in this
// run and alike in all, by how much they differ between the runs, and the logarithms of the way and
// of the width of the spikes of each axis.
struct CircleEquations {
  Eigen::MatrixXd centre, causes, smooth, instrument, shapes, alike, between, ways;
  Eigen::VectorXd radial;
  Eigen::VectorXd travelled;  // rad: along the path, a turn more between senses and passes
};

// The noise of each run along `travelled`, white part and memory; empty: white and alike in all runs.
using CircleMemory = std::vector<estimation::NoiseMemory>;

struct CircleNoise {
  double deviation = 0.0;  // m
  CircleMemory memory;     // in units of `deviation`
};

// The equations of run number `at` about its middle, so that the square of the offset of the centre
// is negligible.
CircleEquations CentredEquations(const std::vector<const paths::CircleRun*>& runs, std::size_t at,
                                 const CauseOptions& options, const ReversalForm& form);

// The causes and what spikes do alike in all runs, at points so close that none of a spike is missed.
CircleEquations SpikesOnGrid(const paths::CircleRun& run, const CauseOptions& options,
                             const ReversalForm& form);

struct CircleFit {
  estimation::Result result;
  // For each run: the deviations without the causes, their fitted smooth part (with the errors of
  // the instrument), and the residuals.
  std::vector<Eigen::VectorXd> unexplained, smooth, noise;
  std::vector<Eigen::VectorXd> white;  // the residuals over their memory, in m of `deviation`
  // What the fit adds to the logarithm of the way and of the width of each axis.
  std::array<double, 2> longer{}, wider{};
  double improbable = 0.0;  // half the sum of the squares of what spikes do beside their form
};

CircleFit SolveCircles(const std::vector<CircleEquations>& equations,
                       const std::vector<standards::Signature>& causes, const CauseOptions& options,
                       const CircleNoise& noise);

// The noise of each run by the residuals of a fit with white noise of `deviation`, in units of it
// (row_memory.h); empty where none drifts.
CircleMemory MemoryOf(const std::vector<CircleEquations>& equations,
                      const std::vector<standards::Signature>& causes, const CauseOptions& options,
                      double deviation);

}  // namespace abbe::fusion
