// How much larger than stated the noise of a run is, by what a fit leaves of it.
//
// What a model of an arm leaves beyond the stated noise is noise until a cause explains it: no such
// model is as exact as a tracker, and against the noise of the tracker every cause would be
// certain. A slow drift is none: what a level and one exp(-time / tau) of any tau explain in x, y
// and z is taken out before. Poses that follow each other share the rest, so its variance counts
// as often as they do:
//
//   excess^2 = chi-square / redundancy * (1 + 2 sum of rho_k),   rho_k: correlation k poses apart,
//
// the sum up to the first that white noise could have. Poses that are all of one time are of no
// known order: then neither a drift nor what neighbours share is seen. Up to kNoiseIsKnown the
// stated noise stands.
// Units: none; residuals in standard deviations.
// Failure: none.
// Source: Sokal, Monte Carlo methods (1996), 2 (integrated autocorrelation). Shapes: three rows, x,
// y and z, for each pose.
// Validity: of n poses a correlation is known to 1 / sqrt(n).
#pragma once

#include <Eigen/Core>

#include "estimation/result.h"

namespace abbe::simulation {

inline constexpr double kNoiseIsKnown = 1.05;

// `left`: the residual in the order of the poses, whitened with `used` times the stated noise;
// `time`: of each pose, s, ascending.
double ExcessOf(const estimation::SourceResult& run, const Eigen::VectorXd& left,
                const Eigen::VectorXd& time, double used);

// What two runs of an arm leave at the same angles, several balls on its hand or a repeat, is not
// noise of each: the correlation of all that is left of both; 0 where it could be by chance. A run
// that shares with others counts their sum, and one for itself, times as much variance.
// Shapes: pivots x poses and three rows for each pose, whitened alike.
double SharedLeft(const Eigen::MatrixXd& angles, const Eigen::VectorXd& left,
                  const Eigen::MatrixXd& other_angles, const Eigen::VectorXd& other_left);

}  // namespace abbe::simulation
