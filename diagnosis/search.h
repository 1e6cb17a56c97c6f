// The search for causes: which are taken in, one after the other, and what is left in the end.
//
//   Search search(campaign);
//   const Diagnosis diagnosis = search.Run();
//
// Forward selection: all candidates are scored against the fit so far, and beside them something
// that is in no catalogue (something_else.h); the one with the largest evidence is taken in when
// anything at all is more probable than kCertain although each of the n candidates had only
// kPresent / n before; its shape is refined; everything is fitted and scored anew. Then each is
// left out once: one that the others have made superfluous goes, and a finding is no more probable
// than it is beside all others.
// The evidence of a cause with a shape is the mean over its shapes: looking at many periods costs
// what it should. Units: SI. Failure: that of Fit.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/shortlist.h"
#include "diagnosis/something_else.h"

namespace abbe::diagnosis {

// Probability of a rival that is not worth a word.
inline constexpr double kNegligible = 0.01;

class Search {
 public:
  explicit Search(const Campaign& campaign);

  Diagnosis Run();
  // Logarithm of the odds of the most probable cause or structure against nothing, to first order,
  // before anything is taken in.
  double LogOddsOfFirst();
  // With all that was taken in.
  const Fit& fit() const { return *fit_; }
  const Fit& base() const { return *base_; }  // without causes

 private:
  using FitPointer = std::shared_ptr<const Fit>;
  // A cause, or something else: then what was asked for, and what it says.
  struct Member {
    Finding finding;
    std::optional<Found> other = {};
    Leftover unexplained = {};
    double log_prior = 0.0;  // log odds that it is there, before any data
    double beside = 1.0;     // probability that it is there beside all others
  };

  // search.cpp: what is taken in.
  void ScoreRound();
  std::vector<Named> NamesLeft() const;
  bool TakeBest();
  bool TakeCause(const std::vector<Named>& names, FitPointer decided);
  bool TakeSomethingElse(Found found);
  bool TakeIn(Member member, FitPointer fit);
  bool MayOutweigh(const std::vector<Named>& names) const;
  bool Outweighs(std::vector<Named>& names, FitPointer& fitted) const;
  std::vector<double> LogOdds(const std::vector<Named>& names) const;
  double LogOddsOfSomethingElse() const;
  FitPointer DecideByFits(std::vector<Named>& names);
  FitPointer FitWith(const std::vector<Candidate>& taken, int rounds = Fit::kMostRounds) const;
  bool Predicts(const Fit& fit) const;

  std::vector<Candidate> Taken() const;
  std::vector<Candidate> Others(std::size_t than) const;
  std::size_t CausesTaken() const;

  void DescribeFirstRound(const std::vector<Named>& names);
  void NoteShown(const std::vector<Named>& names);

  // judgement.cpp: what is said of it in the end.
  bool IsBeyondDoubt(std::size_t i) const;
  double LogPosteriorBeside(const Fit& without, std::size_t i) const;
  void DropSuperfluous();
  void ForgiveRivalsFound();
  double SomethingElseInstead(std::size_t i) const;
  std::vector<Score> Scores() const;
  void AddBadData();
  void Describe();

  const std::vector<Candidate> candidates_;
  const std::size_t rim_sensors_;
  SomethingElse others_;
  std::vector<Member> members_;
  std::vector<Candidate> refused_;
  FitPointer base_, fit_;
  std::vector<Named> shortlist_;           // beside those taken in
  std::vector<Found> structures_;          // the same, of what is in no catalogue
  std::optional<Found> other_;             // the best of these
  std::map<std::string, double> by_fits_;  // log evidence, of those whose fits were made
  Diagnosis diagnosis_;
};

}  // namespace abbe::diagnosis
