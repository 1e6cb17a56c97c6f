// Whether the runs of a fit agree: what each of them says against what all others say.
//
//   for (const RunConsistency& run : CheckRuns(problem, sums)) ...
//
// Background: at the common estimate x, run r has the information D and the score g = J'r of its
// own rows; all others and the priors have the information H. Without run r the estimate would be
// x + H^-1 g. There the score of run r is s = (1 + D H^-1) g, and if all is stated truly its
// covariance is D + D H^-1 D. In the directions v that run r sees better than it was known
// (lambda > 1/2 of L'DL, H^-1 = LL'):
//
//   T = sum over these of (1 + lambda) / lambda * (v' L' g)^2      chi-square, one for each
//
// The rows of a run are thousands, what they say of the machine is a handful of numbers: T looks at
// these, the run's own chi-square at the rows. Unknowns that only this run sees are eliminated.
// Source: the predictive form of Baarda's test, e.g. Teunissen, "Testing Theory" (2006); own form.
// Validity: to first order at the solution. A run that is wrong pulls all others: the smallest
// probability names the wrong one when at least two others agree; of two runs it can only say that
// they contradict each other.
#pragma once

#include <string>
#include <vector>

#include "estimation/linearization.h"
#include "estimation/problem.h"

namespace abbe::fusion {

struct RunConsistency {
  std::string name;
  double statistic = 0.0;    // T
  int directions = 0;        // its degrees of freedom; 0: nothing that others know too
  double probability = 1.0;  // of a T as large by chance
};

// In the order of the sources; those that are priors are left out. `sums`: of the problem at its
// solution.
std::vector<RunConsistency> CheckRuns(const estimation::Problem& problem,
                                      const estimation::Linearization& sums);

// The run that contradicts the others, an index into `runs`; -1: none does at 1 % for the whole
// set.
int Contradicting(const std::vector<RunConsistency>& runs);

}  // namespace abbe::fusion
