// How much a run is expected to tell of what is the matter: the mean fall of the entropy over the
// worlds.
//
//   const double bits = ExpectedInformation(before, after, worlds.list);
//
// World t is true with coefficients a, which are drawn from what is known of them. The score of a
// world x is then S_xt a on average and its log evidence that of diagnosis/expected_odds.h,
//
//   ( m' M m + tr(M S_xx) - log det(1 + S_xx P^-1) ) / 2,    m = S_xt a,  M = (S_xx + P)^-1,
//
// whose growth by the run multiplies the present odds. Each a is one of three sizes, in the middle
// of the thirds of a normal distribution, in one direction that is always the same.
// Units: SI; bits. Shapes: S of all coefficients, world after world.
// Failure: none.
// Source: Lindley, Annals of Mathematical Statistics 27 (1956).
// Validity: to first order; odds by the mean evidence, not by its scatter.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "investigate/worlds.h"

namespace abbe::investigate {

// One a world, 0 of nothing; `score`: the mean score of all coefficients.
Eigen::VectorXd ExpectedEvidence(const Eigen::MatrixXd& S, const std::vector<World>& worlds,
                                 const Eigen::VectorXd& score);

// `before`, `after`: information of the runs without and with the one in question.
double ExpectedInformation(const Eigen::MatrixXd& before, const Eigen::MatrixXd& after,
                           const std::vector<World>& worlds);

}  // namespace abbe::investigate
