// What a search says of its members in the end: which the others have made superfluous, how
// probable each is beside all others, what is left, and the verdict.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "diagnosis/alias_group.h"
#include "diagnosis/doubts.h"
#include "diagnosis/leftovers.h"
#include "diagnosis/scatter.h"
#include "diagnosis/search.h"
#include "diagnosis/shape_posterior.h"
#include "diagnosis/structure_search.h"
#include "failure/failure.h"
#include "simulation/causes/registry.h"

namespace abbe::diagnosis {
namespace {

Verdict VerdictOf(const Diagnosis& diagnosis) {
  if (!diagnosis.leftovers.empty()) return Verdict::kUnexplained;
  if (diagnosis.findings.empty()) return Verdict::kClean;
  const bool certain =
      std::all_of(diagnosis.findings.begin(), diagnosis.findings.end(),
                  [](const Finding& finding) { return finding.probability >= kCertain; });
  return certain ? Verdict::kExplained : Verdict::kAmbiguous;
}

// What is not seen of a cause that is always there is unknown still, and moves the sizes of those
// that are.
std::shared_ptr<const Fit> WithThoseAlwaysThere(std::shared_ptr<const Fit> fit,
                                                const std::vector<Candidate>& all) {
  std::vector<Candidate> with = fit->taken_in();
  if (with.empty()) return fit;
  for (const Candidate& each : all) {
    if (each.cause->always_there && !IsAmong(with, each)) with.push_back(each);
  }
  if (with.size() == fit->taken_in().size()) return fit;
  try {
    return std::make_shared<const Fit>(*fit, std::move(with));
  } catch (const NumericalError&) {
    return fit;
  }
}

}  // namespace

// Whether, all others at their best, it is so probable that no fit without it is needed.
bool Search::IsBeyondDoubt(std::size_t i) const {
  constexpr double kBeyond = 15.0;  // in log odds, to first order
  const Member& member = members_[i];
  const Candidate& candidate = member.finding.score.candidate;
  if (candidate.cause->relaxes || candidate.cause->IsBinary()) return false;
  const Fit::Projection beside = fit_->ProjectionOf(i);
  const double log_evidence = member.other
                                  ? Explained(member.other->structure, beside).drawn.log_evidence
                                  : ScoreFrom(fit_->taken_in()[i], beside).log_evidence;
  return log_evidence + member.log_prior > kBeyond;
}

// Log odds of a member that is left out, beside all others. What is there or not is too large for
// the first order.
double Search::LogPosteriorBeside(const Fit& without, std::size_t i) const {
  const Member& member = members_[i];
  const Candidate& candidate = member.finding.score.candidate;
  const double log_evidence =
      member.other                  ? Asked(without, member.other->structure).drawn.log_evidence
      : candidate.cause->IsBinary() ? fit_->log_likelihood() - without.log_likelihood()
                                    : ScoreAll(without, {candidate}).front().log_evidence;
  return log_evidence + member.log_prior;
}

// Leaves out what the others explain as well, the least probable first: each that goes may be what
// made another one superfluous.
void Search::DropSuperfluous() {
  for (;;) {
    for (Member& member : members_) member.beside = 1.0;
    if (members_.size() < 2) return;
    std::size_t least = 0;
    double least_odds = 0.0;
    FitPointer without_least;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      FitPointer without = IsBeyondDoubt(i) ? nullptr : FitWith(Others(i));
      if (!without) continue;
      const double log_odds = LogPosteriorBeside(*without, i);
      members_[i].beside = ProbabilityOf(log_odds);
      if (log_odds > least_odds) continue;
      least = i;
      least_odds = log_odds;
      without_least = std::move(without);
    }
    if (!without_least) return;
    members_.erase(members_.begin() + least);
    structures_.clear();
    fit_ = std::move(without_least);
  }
}

// Two sensors of unequal gain were rivals for who goes first; both are there.
void Search::ForgiveRivalsFound() {
  const std::vector<Candidate> taken = Taken();
  for (Member& member : members_) {
    Finding& finding = member.finding;
    std::erase_if(finding.rivals, [&](const Rival& rival) {
      const bool found =
          rival.candidate.cause == finding.score.candidate.cause && IsAmong(taken, rival.candidate);
      if (found) finding.probability = std::min(1.0, finding.probability + rival.probability);
      return found;
    });
  }
}

// In the order of the members. A shape that is hardly known widens the other parameters too.
std::vector<Score> Search::Scores() const {
  std::vector<Score> scores;
  const FitPointer fit = WithThoseAlwaysThere(fit_, candidates_);
  for (std::size_t i = 0; i < members_.size(); ++i) scores.push_back(fit->ScoreOf(i));
  std::vector<Eigen::MatrixXd> added(members_.size());
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const bool hardly_known = IsHardlyKnown(scores[i]), aliases = MayHaveAliases(scores[i]);
    if (members_[i].other || (!hardly_known && !aliases)) continue;
    const auto without = FitWith(Others(i));
    if (!without) continue;
    if (aliases) scores[i] = AmongAliases(*without, std::move(scores[i]));
    if (!hardly_known) continue;
    const ShapePosterior shapes(*without, std::move(scores[i]));
    scores[i] = shapes.Widened();
    const std::vector<Eigen::MatrixXd> more = shapes.Added();
    for (std::size_t other = 0; other < more.size(); ++other) {
      Eigen::MatrixXd& sum = added[other < i ? other : other + 1];
      sum = sum.size() == 0 ? more[other] : sum + more[other];
    }
  }
  for (std::size_t i = 0; i < scores.size(); ++i) {
    scores[i].covariance.topLeftCorner(added[i].rows(), added[i].cols()) += added[i];
  }
  return scores;
}

// Found row by row, so certain.
void Search::AddBadData() {
  for (const InvalidReadings& bad : fit_->campaign().invalid_readings()) {
    const simulation::Cause& cause = simulation::CauseNamed(bad.cause);
    Finding finding{{{&cause, bad.object, {}}, {}, {}}, 1.0, {}};
    finding.score.coefficients = cause.coefficients() == 1
                                     ? Eigen::VectorXd::Constant(1, bad.count)
                                     : Eigen::VectorXd(Eigen::Vector2d(bad.from, bad.to));
    finding.score.covariance = Eigen::MatrixXd::Zero(cause.coefficients(), cause.coefficients());
    diagnosis_.findings.push_back(std::move(finding));
  }
}

// Probability that something else does what a cause does, all other causes known by now.
double Search::SomethingElseInstead(std::size_t i) const {
  const FitPointer without = FitWith(Others(i));
  if (!without) return members_[i].finding.something_else;
  const std::vector<Found> structures = FindStructures(*without);
  const auto other = MostProbable(*without, structures);
  if (!other) return 0.0;
  const double cause = fit_->log_likelihood() - without->log_likelihood() + members_[i].log_prior;
  return ProbabilityOf(LogPosterior(*other, structures.size()) -
                       LogSumOfExponentials({0.0, cause}));
}

void Search::Describe() {
  const std::vector<Score> scores = Scores();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    if (member.other) {
      diagnosis_.leftovers.push_back(member.unexplained);
      continue;
    }
    Score& score = member.finding.score;
    const double visible = score.visible, log_evidence = score.log_evidence;
    score = scores[i];
    score.visible = visible;
    score.log_evidence = log_evidence;
    member.finding.curve = CurveOf(*base_, *fit_, i);
    // Where something else is there, the cause was judged beside it; else against it.
    double& something_else = member.finding.something_else;
    if (CausesTaken() < members_.size()) something_else = 0.0;
    if (something_else > kNegligible) something_else = SomethingElseInstead(i);
    if (something_else < kNegligible) something_else = 0.0;
    member.finding.probability *= member.beside * (1.0 - something_else);
    // What was found was shown after all.
    std::erase(diagnosis_.cannot_show, score.candidate.Name());
    diagnosis_.findings.push_back(member.finding);
  }
  diagnosis_.map_change = MapChange(*base_, *fit_);
  AddBadData();
  for (Leftover& left :
       LeftoversOf(*fit_, structures_.empty() ? FindStructures(*fit_) : structures_)) {
    diagnosis_.leftovers.push_back(std::move(left));
  }
  for (Leftover& run : RunsThatScatter(*fit_)) diagnosis_.leftovers.push_back(std::move(run));
  if (!diagnosis_.leftovers.empty()) {
    for (Finding& finding : diagnosis_.findings) {
      finding.probability = std::min(finding.probability, kBesideUnexplained);
    }
  }
  diagnosis_.chi_after = fit_->chi_square() / fit_->rows();
  diagnosis_.verdict = VerdictOf(diagnosis_);
  AddDoubts(fit_->campaign().scene(), diagnosis_);
  diagnosis_.fitted = fit_->result();
  if (diagnosis_.verdict == Verdict::kUnexplained) diagnosis_.base = base_;
}

}  // namespace abbe::diagnosis
