// The noise of a positioning test, from how well its readings repeat.
//
//   if (const auto noise = NoiseOfRepeats(run)) SetNoise(noise->sd, run);
//
// A reading of target i, approached in direction s in cycle j, is taken apart as
//
//   mean of the target and direction (i, s)  +  offset (s, j)  +  slope (s, j) position  +  noise
//
// by least squares: the error of the axis and its reversal are in the first, whatever drifts or
// grows from one way of the axis to the next in the second and third. Only what is left counts,
// over its degrees of freedom f; the variance is that of Student's distribution, f / (f - 2) times
// as large, for a fit that takes it as known and normal.
// Frames: each direction of the instrument for itself.
// Units: m. Nothing for a run that is no positioning test or leaves fewer than kLeastFreedom
// degrees. Shapes: one deviation a direction.
// Failure: InputError where all readings repeat to their last digit.
// Source: own; ISO 230-2 has the cycles and approaches.
// Validity: what changes the shape of the error over position between cycles counts as noise.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "simulation/points/reference_run.h"

namespace abbe::simulation {

inline constexpr Eigen::Index kLeastFreedom = 6;

struct RepeatNoise {
  Eigen::Vector3d sd;  // in each direction that the instrument shows
  Eigen::Index freedom;
};

// InputError with the recording's name where all readings repeat to their last digit.
std::optional<RepeatNoise> NoiseOfRepeats(const ReferenceRun& run);

// In all rows that state none.
void SetNoise(const Eigen::Vector3d& sd, ReferenceRun& run);

}  // namespace abbe::simulation
