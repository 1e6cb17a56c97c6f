// The causes in the order of what the data say for them, each by name: at one object, with the best
// of its shapes.
//
//   std::vector<Named> names = Shortlist(fit, candidates);
//   names.front().log_evidence;              // of all its shapes together
//   Refine(fit, names.front()).candidate;    // between the shapes that were tried
//
// Units: SI.
#pragma once

#include <vector>

#include "diagnosis/candidate.h"
#include "diagnosis/fit.h"

namespace abbe::diagnosis {

struct Named {
  Score best;
  double log_evidence = 0.0;  // mean over all shapes; of a line, over all that are resolved
  double step = 1.0;          // from the best shape to the next one tried, a factor
};

// Shapes of one cause and object stand together in `candidates`.
std::vector<Named> Shortlist(const Fit& fit, const std::vector<Candidate>& candidates);
void SortByEvidence(std::vector<Named>& names);

// The shape with the largest evidence near the best one that was tried.
Score Refine(const Fit& fit, const Named& named);

// For a binary cause: the evidence if it could be there in part.
double EvidenceOfAPart(const Score& score);

// Logarithm of the sum of the exponentials.
double LogSumOfExponentials(const std::vector<double>& logs);
// The probability that has these log odds.
double ProbabilityOf(double log_odds);

}  // namespace abbe::diagnosis
