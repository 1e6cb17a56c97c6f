#include "learned/learning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/scatter.h"
#include "diagnosis/something_else.h"
#include "diagnosis/where_it_shows.h"
#include "failure/failure.h"
#include "learned/certificate.h"
#include "learned/confounding.h"
#include "simulation/variables.h"

namespace abbe::learned {
namespace {

using diagnosis::Candidate;
using diagnosis::Fit;
using diagnosis::Found;
using diagnosis::Leftover;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::LearnedCause;
using simulation::LearnedTerm;
using FitPointer = std::shared_ptr<const Fit>;

constexpr std::size_t kMostTerms = 3;
constexpr double kProbable = 4.6;  // log odds, 99 %
constexpr double kImitated = 0.9;  // of its effect, or cosine: one group
constexpr double kFalseDiscovery = 0.05;

// What the runs covered of the variables of an expression.
std::vector<simulation::Covered> CoveredBy(const Fit& fit, const LearnedTerm& term) {
  std::vector<simulation::Covered> covered;
  const auto channel = simulation::ChannelNamed(term.object).value();
  for (const std::string& variable : term.expression.Variables()) {
    const auto range = diagnosis::RangeOf(variable, channel, fit.campaign().scene());
    const double unit = simulation::UnitOf(variable).si;
    if (range) covered.push_back({variable, range->first / unit, range->last / unit});
  }
  return covered;
}

LearnedTerm TermOf(const Fit& fit, const Rated& rated) {
  LearnedTerm term{.object = rated.proposal.channel.object,
                   .expression = rated.proposal.expression(),
                   .coefficients = rated.coefficients,
                   .covariance = rated.by_numbers,
                   .u95_of_numbers = rated.u95_of_numbers};
  term.covered = CoveredBy(fit, term);
  return term;
}

// A smooth function as cubic B-splines, as many parts as cosines it needs.
LearnedTerm SmoothTermOf(const Fit& fit, const Found& found) {
  const diagnosis::Structure& structure = found.structure;
  const double unit = simulation::UnitOf(structure.variable).si;
  const auto parts = static_cast<double>(structure.terms);
  LearnedTerm term{.object = structure.channel.object,
                   .expression = simulation::Expression{{simulation::Product{
                       Atom{Atom::Form::kSpline,
                            structure.variable,
                            {structure.range.first / unit, structure.range.last / unit, parts}}}}},
                   .coefficients = {},
                   .covariance = {}};
  term.covered = CoveredBy(fit, term);
  return term;
}

struct Step {
  FitPointer fit;
  std::vector<Learned> terms;
  std::vector<Leftover> left;
  std::vector<const TermSearch*> searches;  // that found each
};

// A term as the next one, not fitted yet. Coefficients of a smooth one are draws.
Learned Prepared(LearnedTerm term, bool is_smooth, double drawn) {
  Learned learned{.cause = LearnedCause::Of(std::move(term)), .candidate = {}, .fitted = {}};
  learned.is_smooth = is_smooth;
  auto cause = std::make_shared<simulation::Cause>(learned.cause->cause());
  VectorXd shape;
  if (is_smooth) {
    cause->amount = simulation::Amount::kRandomField;
    cause->plausible = VectorXd::Ones(cause->plausible.size());
    shape = Eigen::Vector2d(drawn, 0.0);
  }
  learned.candidate = {cause.get(), learned.cause->object(), shape};
  learned.fitted = std::move(cause);
  return learned;
}

std::vector<Candidate> With(const std::vector<Candidate>& causes,
                            const std::vector<Learned>& terms) {
  std::vector<Candidate> all = causes;
  for (const Learned& term : terms) all.push_back(term.candidate);
  return all;
}

std::vector<Leftover> LeftBeside(const Fit& fit, const std::vector<Found>& structures) {
  std::vector<Leftover> left = diagnosis::LeftoversOf(fit, structures);
  for (Leftover& run : diagnosis::RunsThatScatter(fit)) left.push_back(std::move(run));
  return left;
}

FitPointer Fitted(const FitPointer& before, const std::vector<Candidate>& candidates) {
  try {
    return std::make_shared<const Fit>(*before, candidates);
  } catch (const NumericalError&) {
    return nullptr;
  }
}

// Rms of what the term does, over the rows that feel it.
double AmplitudeOf(const Fit& fit, const LearnedTerm& term) {
  const auto channel = simulation::ChannelNamed(term.object).value();
  double squares = 0.0, sum = 0.0, rows = 0.0;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const simulation::Trace& trace = fit.TraceOf(run);
    if (trace.rows() == 0 || !channel.Feels(trace)) continue;
    const MatrixXd functions = term.expression.Of(trace);
    if (functions.rows() == 0) continue;
    const Eigen::RowVectorXd effect = term.coefficients.transpose() * functions;
    squares += effect.squaredNorm();
    sum += effect.sum();
    rows += static_cast<double>(effect.size());
  }
  return rows > 0.0 ? std::sqrt(std::max(0.0, squares / rows - std::pow(sum / rows, 2))) : 0.0;
}

// Coefficients and covariance as the fit with everything has them.
void TakeSizes(const Step& step, std::size_t causes, std::vector<Learned>& terms) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const diagnosis::Score score = step.fit->ScoreOf(causes + i);
    LearnedTerm term = terms[i].term();
    const Index count = score.coefficients.size();
    const MatrixXd by_numbers = term.covariance;
    term.coefficients = score.coefficients;
    term.covariance = score.covariance.topLeftCorner(count, count);
    if (by_numbers.size() == term.covariance.size()) term.covariance += by_numbers;
    terms[i].amplitude = AmplitudeOf(*step.fit, term);
    terms[i].cause = LearnedCause::Of(std::move(term));
  }
}

class Learner {
 public:
  Learner(FitPointer base, std::vector<Candidate> causes)
      : causes_(std::move(causes)),
        start_(causes_.empty() ? base : Fitted(base, causes_)),
        base_(std::move(base)) {}

  // Terms until nothing is left, expressions or smooth functions.
  Step Run(bool only_smooth);
  const FitPointer& start() const { return start_; }
  const FitPointer& base() const { return base_; }
  const std::vector<Candidate>& causes() const { return causes_; }

 private:
  bool TakeNext(bool only_smooth, const std::vector<Found>& structures, Step& step);

  std::vector<Candidate> causes_;
  FitPointer start_, base_;
  std::vector<TermSearch> searches_;
};

bool Learner::TakeNext(bool only_smooth, const std::vector<Found>& structures, Step& step) {
  // The first search is the same for both ways.
  if (!step.terms.empty() || searches_.empty()) {
    searches_.reserve(2 * kMostTerms);  // they are pointed to
    searches_.push_back(SearchTerms(*step.fit, structures));
  }
  const TermSearch& search = step.terms.empty() ? searches_.front() : searches_.back();
  const bool has_expression = !search.best.empty() && search.best.front().log_posterior > kProbable;
  const bool has_smooth = search.smooth && search.log_posterior_of_smooth > kProbable;
  const bool smooth_first =
      has_smooth && (only_smooth || !has_expression ||
                     search.log_posterior_of_smooth > search.best.front().log_posterior);
  if (!smooth_first && (only_smooth || !has_expression)) return false;
  Learned next = smooth_first
                     ? Prepared(SmoothTermOf(*step.fit, *search.smooth), true,
                                search.smooth->drawn.sd)
                     : Prepared(TermOf(*step.fit, search.best.front()), false, 0.0);
  std::vector<Learned> terms = step.terms;
  terms.push_back(std::move(next));
  const FitPointer fit = Fitted(start_, With(causes_, terms));
  if (!fit) return false;
  std::vector<const TermSearch*> searches = step.searches;
  searches.push_back(&search);
  step = {fit, std::move(terms), {}, std::move(searches)};
  return true;
}

Step Learner::Run(bool only_smooth) {
  Step step{start_, {}, {}, {}};
  std::vector<Found> structures = diagnosis::FindStructures(*start_);
  step.left = LeftBeside(*start_, structures);
  while (!step.left.empty() && step.terms.size() < kMostTerms) {
    if (!TakeNext(only_smooth, structures, step)) break;
    structures = diagnosis::FindStructures(*step.fit);
    step.left = LeftBeside(*step.fit, structures);
  }
  if (!step.terms.empty()) TakeSizes(step, causes_.size(), step.terms);
  return step;
}

std::vector<Candidate> ModelledOf(const diagnosis::Diagnosis& diagnosis) {
  std::vector<Candidate> causes;
  for (const auto& finding : diagnosis.findings) {
    if (diagnosis::IsModelled(finding)) causes.push_back(finding.score.candidate);
  }
  return causes;
}

// Only what runs of probes, of the linkage on a machine, and of a reference say is learned from.
bool MayLearn(const diagnosis::Diagnosis& diagnosis) {
  if (!diagnosis.campaign || !diagnosis.base) return false;
  const diagnosis::Campaign& campaign = *diagnosis.campaign;
  return !campaign.EstimatesNoise() && !campaign.scene().OnlyShafts() &&
         !campaign.scene().travel.isZero(0.0);
}

void Certify(const Learner& learner, const Step& step, Learning& learning) {
  for (std::size_t i = 0; i < step.terms.size(); ++i) {
    Learned learned = step.terms[i];
    const Confounding confounding =
        ConfoundingOf(*step.fit, learned.candidate, learner.base(), learner.causes());
    LearnedTerm term = learned.term();
    term.certificate.by_chance = ByChance(*step.searches[i], learned.is_smooth);
    term.certificate.regime = RegimeOf(*step.fit, learned, learner.causes().size() + i);
    term.certificate.imitated = confounding.imitated;
    term.certificate.nearest = confounding.nearest;
    term.certificate.cosine = confounding.cosine;
    learned.group = confounding.group;
    if (!learned.group.empty()) {
      learned.doubts.push_back("a named cause can do the same");
    } else if (confounding.imitated > kImitated) {
      learned.doubts.push_back(fmt::format(
          "parameters of the simulation can make {:.0f} % of its effect", 100.0 * confounding.imitated));
    }
    learned.curve = diagnosis::CurveOf(*learner.start(), *step.fit, learner.causes().size() + i);
    learned.cause = LearnedCause::Of(std::move(term));
    learning.terms.push_back(std::move(learned));
  }
}

// Benjamini and Hochberg: the largest k whose p-value is at most k / n of the rate.
double LargestPassing(std::vector<double> chances) {
  std::ranges::sort(chances);
  double passing = 0.0;
  for (std::size_t k = 0; k < chances.size(); ++k) {
    const double share = static_cast<double>(k + 1) / static_cast<double>(chances.size());
    if (chances[k] <= share * kFalseDiscovery) passing = chances[k];
  }
  return passing;
}

}  // namespace

std::vector<Candidate> Learning::Candidates() const { return With(causes, terms); }

Learning Learn(const diagnosis::Diagnosis& diagnosis) {
  Learning learning;
  learning.before = diagnosis.leftovers;
  if (!MayLearn(diagnosis)) return learning;
  learning.causes = ModelledOf(diagnosis);
  Learner learner(diagnosis.base, learning.causes);
  if (!learner.start()) return learning;
  Step step = learner.Run(false);
  const auto is_smooth = [](const Learned& term) { return term.is_smooth; };
  if (!step.left.empty() && !std::ranges::all_of(step.terms, is_smooth)) {
    // No expression that leaves something is told; a smooth function may leave nothing.
    Step smooth = learner.Run(true);
    if (smooth.left.empty()) step = std::move(smooth);
  }
  if (step.terms.empty()) return learning;
  const auto rows = static_cast<double>(step.fit->rows());
  learning.chi_before = learner.start()->chi_square() / rows;
  learning.chi_after = step.fit->chi_square() / rows;
  learning.left = step.left;
  Certify(learner, step, learning);
  return learning;
}

void Decide(const diagnosis::HeldOutGain& gain, Learning& learning,
            diagnosis::Diagnosis& diagnosis) {
  if (learning.terms.empty()) return;
  std::vector<double> chances;
  for (const Learned& learned : learning.terms) {
    chances.push_back(learned.term().certificate.by_chance);
  }
  const double passing = LargestPassing(chances);
  bool all = learning.left.empty();
  for (std::size_t i = 0; i < learning.terms.size(); ++i) {
    Learned& learned = learning.terms[i];
    LearnedTerm term = learned.term();
    if (term.certificate.by_chance > passing) {
      learned.doubts.push_back("noise makes as much in more than 5 %");
    }
    const std::size_t place = learning.causes.size() + i;
    if (place >= gain.without.size()) {
      learned.doubts.push_back("nothing could be held out to test it");
    } else {
      term.certificate.heldout_before = gain.without[place].held;
      term.certificate.heldout_after = gain.after;
      if (!(gain.after < gain.without[place].held)) {
        learned.doubts.push_back("rows that were held out come out worse with it");
      }
    }
    if (!learning.left.empty()) {
      learned.doubts.push_back("something is left beside it");
    }
    learned.cause = LearnedCause::Of(std::move(term));
    all = all && learned.IsFound();
  }
  if (!all) return;
  diagnosis.verdict = diagnosis::Verdict::kLearned;
  diagnosis.leftovers.clear();
  diagnosis.chi_after = learning.chi_after;
}

}  // namespace abbe::learned
