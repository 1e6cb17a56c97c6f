// A learned term: what a stage of the simulation does that no cause of the catalogue describes, as
// an expression of recorded variables, with what certifies it.
//
//   const auto learned = LearnedCause::Of(term);
//   learned->cause().columns(trace, learned->object(), {});    // as of any cause
//
// In a file it is a table [[learned]] of the extended model (docs/extended-model.md).
// Units: coefficients in m or rad for each unit of their summand, which is that of its variables
// (expression.h). Shapes: one coefficient for each column of the expression.
// Failure: InputError with file, line and key for a table that contradicts itself.
// Source: own; docs/learned.md.
// Validity: beyond the range that the runs covered, a variable counts as at its border.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "settings/document.h"
#include "simulation/causes/cause.h"
#include "simulation/learned/expression.h"

namespace abbe::simulation {

// What a variable covered in the runs, in its unit.
struct Covered {
  std::string variable;
  double from, to;
};

// Why a term is believed.
struct Certificate {
  double by_chance = 1.0;  // probability of as much in noise, the whole grammar asked
  double heldout_before = 0.0, heldout_after = 0.0;  // rms of the rows held out, in their noise
  std::string regime = "untold";  // beyond what was fitted: kHolds, kFails, kUntold
  double imitated = 0.0;     // share of its effect, rms, that parameters of the simulation can make
  std::string nearest = {};  // the named cause most like it, "backlash:X"; empty: none
  double cosine = 0.0;       // of both, free of the parameters
};
inline constexpr const char *kHolds = "holds", *kFails = "fails", *kUntold = "untold";

struct LearnedTerm {
  std::string object;  // a channel of stage_channel.h
  Expression expression;
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;
  // U95 of the numbers within the expression (P, v0, tau, w), in their units, in the order of its
  // text; empty: not stated.
  std::vector<double> u95_of_numbers = {};
  std::vector<Covered> covered = {};
  Certificate certificate = {};
  std::string name = {}, words = {};  // by a person; empty: not named
};

// The stage of an object, as files state it: "motion", "reading", "encoder", "tip".
std::string StageName(const std::string& object);

// A term as a cause. Its object, its seat and what it follows are those of its channel and its
// variables.
class LearnedCause {
 public:
  static std::shared_ptr<const LearnedCause> Of(LearnedTerm term);
  // As a cause that other machines may have: with the prior of a named one, as large as it was
  // found where it was learned.
  static std::shared_ptr<const LearnedCause> CarriedOn(LearnedTerm term);

  const LearnedTerm& term() const { return term_; }
  const Cause& cause() const { return cause_; }
  Object object() const { return term_.object; }

 private:
  // `times`: the plausible sizes over those of the term.
  LearnedCause(LearnedTerm term, double times);

  LearnedTerm term_;
  Cause cause_;
};

// The table [[learned]].
LearnedTerm ReadLearnedTerm(const settings::Table& table);
std::string LearnedTermText(const LearnedTerm& term);

}  // namespace abbe::simulation
