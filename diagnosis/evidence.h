// How much more probable the data are with a cause than without: all candidates against one fit.
//
//   const Fit fit(campaign);
//   const std::vector<Score> scores = ScoreAll(fit, AllCandidates(campaign.scene()));
//
// From the information S and the score g of a candidate's coefficients c, the nuisance parameters
// of the simulation marginalised (fit.h):
//
//   c ~ N((S + P)^-1 g, (S + P)^-1),    P the precision of plausible coefficients
//   log evidence = (g' (S + P)^-1 g - log det(1 + S P^-1)) / 2
//
// which is the exact marginal likelihood of the linear problem, noise known. A cause that only
// relaxes priors uses the Jacobian columns of those parameters as C. A binary cause has c = 1 and
// the log evidence g - S / 2. Shapes: S and P square in the coefficients, g as many.
// Failure: none; a singular S has no evidence.
// Source: Rasmussen and Williams, Gaussian Processes (2006), 2.7; MacKay, Neural Computation 4
// (1992), for the Occam factor.
// Units: SI.
// Validity: to first order at the fit; score anew after each cause that was taken in.
#pragma once

#include <span>
#include <vector>

#include "diagnosis/candidate.h"
#include "diagnosis/fit.h"

namespace abbe::diagnosis {

// For a random field with coefficients of one standard deviation: that with the largest evidence,
// and the mean evidence of all that are tried, evenly in the logarithm, beyond that of `stated`.
struct DrawnSize {
  double sd, log_evidence;
};
struct SizeRange {
  double smallest, largest, ratio;
};
// `sizes`: tried, `ratio` apart.
DrawnSize SizeOfDraws(const Fit::Projection& projection, const SizeRange& sizes, double stated);

// The columns of candidates with columns, one after the other, for Fit: none for what does not act on
// a run. `candidates` have to live as long.
struct Together {
  Fit::Disturber disturber;
  std::vector<Eigen::Index> groups;  // columns of each
};
Together TogetherOf(std::span<const Candidate> candidates);

Score ScoreFrom(Candidate candidate, const Fit::Projection& projection);
// One score a candidate, in their order.
std::vector<Score> ScoreAll(const Fit& fit, const std::vector<Candidate>& candidates);

}  // namespace abbe::diagnosis
