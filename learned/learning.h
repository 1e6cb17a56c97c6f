// What no known cause explains, learned: terms of the simulation that nobody wrote down, with what
// certifies each.
//
//   diagnosis::Diagnosis diagnosis = diagnosis::Diagnose(campaign);
//   learned::Learning learning = learned::Learn(diagnosis);
//   const auto gain = diagnosis::HoldOut(campaign, recordings, learning.Candidates());
//   learned::Decide(gain, learning, diagnosis);           // verdict "learned", or as it was
//
// Runs only where a diagnosis ended with something left. One term after the other is searched for
// (term_search.h) beside the causes that were found, fitted in full with everything else, and asked
// whether anything is left beside it. A smooth function is a term too, where no expression is as
// probable, or where something is left beside the expressions. A term counts as found when
//   - the whole grammar makes as much out of noise in less than 5 % (Benjamini and Hochberg over the
//     terms of the diagnosis), and rows held out come out better with it,
//   - nothing is left beside the terms: an expression that does not fit is dropped,
//   - no term of another stage or other variables is nearly as probable (1 %),
//   - no named cause can do the same (confounding.h), else both stand as one group.
// Units: SI. Shapes: a term for each candidate. Failure: that of Fit.
// Source: Benjamini and Hochberg, J. R. Statist. Soc. B 57 (1995); docs/theory-diagnosis.md.
// Validity: not for arms before an instrument and shafts: nothing is learned there.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"
#include "learned/term_search.h"
#include "simulation/learned/learned_term.h"

namespace abbe::learned {

struct Learned {
  std::shared_ptr<const simulation::LearnedCause> cause;  // of the term with its certificate
  diagnosis::Candidate candidate;                         // as it is fitted
  std::shared_ptr<const simulation::Cause> fitted;        // what `candidate` points to
  bool is_smooth = false, is_certified = false;
  double amplitude = 0.0;               // m or rad, rms over the rows of the runs
  std::vector<std::string> alike = {};  // other stages where it does the same to these runs
  diagnosis::Curve curve = {};
  std::vector<std::string> rivals = {};  // other terms that are nearly as probable: "X [x * y]"
  std::vector<std::string> group = {};   // named causes that could be it as well
  std::vector<std::string> doubts = {};  // why it does not count as found; empty: it does

  const simulation::LearnedTerm& term() const { return cause->term(); }
  bool IsFound() const { return doubts.empty(); }
};

struct Learning {
  std::vector<Learned> terms;
  std::vector<diagnosis::Leftover> before;   // what the diagnosis had left
  std::vector<diagnosis::Leftover> left;     // what is left beside the terms
  std::vector<diagnosis::Candidate> causes;  // of the catalogue, fitted beside them
  double chi_before = 0.0, chi_after = 0.0;  // chi-square per row

  // Whether rows held out decide.
  bool IsToBeDecided() const { return !terms.empty() && left.empty(); }
  // The causes, then the terms.
  std::vector<diagnosis::Candidate> Candidates() const;
};

// Empty where nothing is left, or nothing can be learned.
Learning Learn(const diagnosis::Diagnosis& diagnosis);

// After the rows held out: `gain` of Candidates(). Where all terms are found and nothing is left
// beside them, the verdict becomes `learned`.
void Decide(const diagnosis::HeldOutGain& gain, Learning& learning,
            diagnosis::Diagnosis& diagnosis);

}  // namespace abbe::learned
