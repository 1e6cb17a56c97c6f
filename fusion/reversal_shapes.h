// What a run does just after the reversals of its axes beside a pulse of one shape and size: a
// spike is higher at one end of an axis than at the other, higher in one run than in the next, and
// no two machines have it in the same form.
//
//   const Eigen::MatrixXd own = ShapesOf(run, spikes, {.size = {6e-6, 0.0}, .width = {0.07, 0.07}});
//
// For the first axis, then for the second, each in units of its standard deviation:
//   - the spike of the table with the sign of the end where the axis turned, twice `size`,
//   - at each end five triangles over the angle since the reversal, whose knots are 0, 1/2, 1, 2,
//     3.5 and 6 widths: a quarter of `size`. A half sine and an exponential pulse of one height and
//     width differ by up to a fifth of it.
// Nothing where `size` is 0.
// Units: m, rad. Shapes: points of the run x 22; `spikes` points x 2, the radial deviation by a
// spike of 1 m of each axis.
// Failure: none.
// Source: own.
// Validity: reversals further apart than 6 widths.
#pragma once

#include <Eigen/Core>
#include <array>

#include "paths/circle_run.h"

namespace abbe::fusion {

struct AfterReversals {
  std::array<double, 2> size{};   // m: of the spikes of each axis
  std::array<double, 2> width{};  // rad
};

inline constexpr double kSpikeBetween = 2.0;  // of its size, from end to end or run to run
Eigen::MatrixXd ShapesOf(const paths::CircleRun& run, const Eigen::MatrixXd& spikes,
                         const AfterReversals& after);

// Twelve triangles of each axis from 0 to 5 widths, at both ends alike, for parameters that all runs
// share: points x 24.
Eigen::MatrixXd ShapesAlike(const paths::CircleRun& run, const AfterReversals& after);

// The spikes of run `at` of `runs` against the mean of all, in the same units: points x
// 2 (runs - 1), the same parameters in each run.
Eigen::MatrixXd SpikesBetweenRuns(const Eigen::MatrixXd& spikes, std::size_t at, std::size_t runs,
                                  const AfterReversals& after);

}  // namespace abbe::fusion
