// A fit of circles in one form of their reversals, its noise estimated: what fusion/circle_causes.h
// averages over forms.
//
//   const CircleTrial trial = FitWith(runs, options, ReversalForm{});
//
// Frames: those of circle_causes.h. Units: SI. Shapes: `found.causes` in the order of CausesOf.
// Failure: NumericalError from the fit.
// Source: fusion/circle_causes.h. For use within fusion/ only.
// Validity: errors small against the radius.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "fusion/circle_causes.h"
#include "fusion/circle_fit.h"
#include "paths/circle_run.h"

namespace abbe::fusion {

// m: the first guess of the noise, below that of any instrument of a machine shop and so small that
// the priors have no effect.
inline constexpr double kLeastRadialNoise = 10e-9;

// A fit and the form it was made with.
struct CircleTrial {
  ReversalForm form;
  CircleCauses found;
  std::array<double, 2> longer{}, wider{};  // CircleFit
  double improbable = 0.0;                  // the same
  double white = 0.0;                       // m: the residuals without what they remember, rms
};

CircleTrial FitWith(const std::vector<const paths::CircleRun*>& runs, const CauseOptions& options,
                    const ReversalForm& form, const CircleMemory& memory = {});

// What the noise of each run remembers beside the fit in this form.
CircleMemory MemoryBeside(const std::vector<const paths::CircleRun*>& runs,
                          const CauseOptions& options, const CircleTrial& trial);

// All points.
Eigen::Index Rows(const std::vector<const paths::CircleRun*>& runs);

}  // namespace abbe::fusion
