// What the odds between rivals will be after runs that are only planned.
//
//   const Eigen::MatrixXd before = linear.Information(recorded);     // linear_runs.h
//   const Eigen::MatrixXd after = linear.Information(with_the_run);
//   ExpectedProbability(before, after, rivals);          // of the right one among them
//
// When rival t is true with its estimated coefficients a, the score of rival x is normal with mean
// m = S_xt a and covariance S_xx (evidence.h), so that its log evidence is on average
//
//   ( m' M m + tr(M S_xx) - log det(1 + S_xx P^-1) ) / 2,       M = (S_xx + P)^-1
//   m - S_xx / 2                                                where it is there or not
//
// with P the precision of plausible coefficients. The logarithm of the odds, which the recordings
// gave, grows by what these averages differ with the run and without, on average. It scatters as
// the score that the run adds, whose covariance is S_after - S_before: by the derivatives
// w = M m (or 1) of the evidence, w' (S_after - S_before) w. The expected probability of the right
// rival is that of this normal distribution, the mean over all of them being true, each with its
// probability now.
// Source: Lindley, Annals of Mathematical Statistics 27 (1956); Chaloner and Verdinelli,
// Statistical Science 10 (1995). Units: SI. Validity: to first order; of more than two rivals the
// odds are taken to scatter together.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/candidate.h"

namespace abbe::diagnosis {

struct RivalWorld {
  Candidate candidate;
  Eigen::VectorXd coefficients;  // estimated
  double probability = 0.0;      // now
};

// The expected evidence of each rival when `truth` is true; S in the order of the rivals.
Eigen::VectorXd ExpectedEvidence(const Eigen::MatrixXd& S, const std::vector<RivalWorld>& rivals,
                                 std::size_t truth);

double ExpectedProbability(const Eigen::MatrixXd& before, const Eigen::MatrixXd& after,
                           const std::vector<RivalWorld>& rivals);

// The first `count` coefficients free of the others, which have these plausible deviations.
Eigen::MatrixXd FreeOfOthers(const Eigen::MatrixXd& S, Eigen::Index count,
                             const Eigen::VectorXd& plausible);

}  // namespace abbe::diagnosis
