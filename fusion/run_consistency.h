// Consistency of the runs of a fit: a test of each run against the prediction of all others.
//
//   for (const RunConsistency& run : CheckRuns(problem, sums)) ...
//
// Background: at the common estimate x, run r has the information D and the score g = J'r of its
// own rows; all others and the priors have the information H. Without run r:
//
//   estimate              x + H^-1 g
//   score of run r there  s = (1 + D H^-1) g
//   its covariance        D + D H^-1 D, under the null hypothesis of no error
//
// The test takes the directions v in which run r has more than half of the information of the
// others (eigenvalue lambda > 1/2 of L'DL, H^-1 = LL'):
//
//   T = sum over these of (1 + lambda) / lambda * (v' L' g)^2      chi-square, one for each
//
// A run has thousands of rows but determines few combinations of parameters. T tests these
// combinations, the run's own chi-square tests the rows. Parameters that only this run determines
// are eliminated.
// Units: none. Shapes: one test a run.
// Failure: none; a run that shares nothing with the others has 0 directions.
// Source: the predictive form of Baarda's test, e.g. Teunissen, "Testing Theory" (2006); own form.
// Validity: to first order at the solution. A wrong run biases the prediction for all others: the
// smallest probability names the wrong one when at least two others agree, which MayBeWrong tells;
// two runs can only contradict each other.
#pragma once

#include <string>
#include <vector>

#include "estimation/linearization.h"
#include "estimation/problem.h"

namespace abbe::fusion {

struct RunConsistency {
  std::string name;
  double statistic = 0.0;    // T
  int directions = 0;        // its degrees of freedom; 0: nothing in common with the others
  double probability = 1.0;  // of a T as large under the null hypothesis
};

// In the order of the sources, without those that are priors. `sums`: the problem linearised at its
// solution.
std::vector<RunConsistency> CheckRuns(const estimation::Problem& problem,
                                      const estimation::Linearization& sums);

// The index of the run that contradicts the others; -1: none at a significance of 1 % for the whole
// set.
int Contradicting(const std::vector<RunConsistency>& runs);

// By how much the disagreement of a run exceeds what its uncertainty and that of the others allow.
double BirgeRatio(const RunConsistency& run);

// The runs that may be the wrong one: without any of them, none contradicts the others. Where there
// are several, the data do not tell which; where there is none, no single run is wrong, but what
// they all are taken to share: the machine as a chain of rigid bodies that stays as it is.
std::vector<int> MayBeWrong(const estimation::Problem& problem,
                            const estimation::Linearization& sums);

// The largest correlation of whitened rows with those one or three after them: probes stand one
// after the other, places in threes. White noise has nearly none; 0 for too few rows to tell.
double CorrelationIn(const Eigen::VectorXd& left);

}  // namespace abbe::fusion
