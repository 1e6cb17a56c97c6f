// Something that is in no catalogue: a structure (structure.h) as a candidate beside the causes.
//
//   SomethingElse others;
//   const Candidate candidate = others.CandidateOf(found);
//   const Fit fit(before, {cause, candidate});
//
// Its coefficients are draws of one standard deviation, estimated with everything else
// (simulation::Amount::kRandomField): zero where nothing is left. In a comparison it has the prior
// probability kElse, shared by all structures that are asked for; a cause has to win against it,
// and where it is there, beside it. It is never a finding, but a part of what is unexplained.
// Units: SI. Shapes: one coefficient for each term of the structure. Failure: none. Validity: as
// long as the object that made it lives.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "diagnosis/candidate.h"
#include "diagnosis/structure_question.h"

namespace abbe::diagnosis {

inline constexpr double kElse = 0.05;  // probability that a machine does something of the kind

class SomethingElse {
 public:
  // Valid as long as this object is.
  Candidate CandidateOf(const Found& found);

 private:
  std::vector<std::unique_ptr<const simulation::Cause>> causes_;
};

// That with the most evidence, each form at its best; none: nothing is asked for.
std::optional<Found> MostProbable(const Fit& fit, const std::vector<Found>& found);
// Other variables with which the data go nearly as well as with that of `most`.
void AddThoseAlike(const Fit& fit, const std::vector<Found>& found, Found& most);
// Log odds that it is there, of so many that were asked for.
double LogPosterior(const Found& found, std::size_t questions);

}  // namespace abbe::diagnosis
