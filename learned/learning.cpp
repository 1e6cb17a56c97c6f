#include "learned/learning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/leftovers.h"
#include "diagnosis/scatter.h"
#include "diagnosis/something_else.h"
#include "diagnosis/structure_search.h"
#include "diagnosis/where_it_shows.h"
#include "failure/failure.h"
#include "failure/progress.h"
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

constexpr std::size_t kMostTerms = 3, kMostSmooth = 2;
constexpr double kProbable = 4.6;     // log odds, 99 %
constexpr double kHardlyLeft = 0.98;  // of its effect: not proposed
constexpr double kImitated = 0.9;     // of its effect, or cosine: one group
constexpr double kFalseDiscovery = 0.05;

// What the runs covered of the variables of an expression.
std::vector<simulation::Covered> CoveredBy(const Fit& fit, const LearnedTerm& term) {
  std::vector<simulation::Covered> covered;
  const auto channel = simulation::ChannelNamed(term.object).value();
  for (const std::string& variable : term.expression.Variables()) {
    const auto range = diagnosis::RangeOf(variable, channel, fit.campaign().scene());
    const double unit = simulation::UnitOf(variable).si;
    if (range)
      covered.push_back({variable, Rounded(range->first / unit), Rounded(range->last / unit)});
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
  const std::string variable = LearnableOf(structure.variable);
  const double unit = simulation::UnitOf(variable).si;
  const auto range =
      diagnosis::RangeOf(variable, structure.channel, fit.campaign().scene()).value();
  const auto parts = static_cast<double>(structure.terms);
  LearnedTerm term{.object = structure.channel.object,
                   .expression = simulation::Expression{{simulation::Product{
                       Atom{Atom::Form::kSpline,
                            variable,
                            {Rounded(range.first / unit), Rounded(range.last / unit), parts}}}}},
                   .coefficients = {},
                   .covariance = {}};
  term.covered = CoveredBy(fit, term);
  return term;
}

std::string TermOfChannel(const std::string& object, const simulation::Expression& expression) {
  return fmt::format("{} [{}]", object, expression.Text());
}

struct Step {
  FitPointer fit;
  std::vector<Learned> terms;
  std::vector<Leftover> left;
  std::vector<Found> structures;            // asked beside the terms
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
  std::vector<Learned> Proposed(const TermSearch& search, bool only_smooth, const Fit& fit) const;
  bool TakeNext(bool only_smooth, Step& step);

  std::vector<Candidate> causes_;
  FitPointer start_, base_;
  std::vector<std::unique_ptr<const TermSearch>> searches_;
};

// Other terms that are nearly as probable; of another place: at another stage, of other variables.
void AddRivals(const TermSearch& search, const Rated& rated, Learned& next) {
  const auto variables = rated.proposal.expression().Variables();
  for (const Rated& other : search.best) {
    if (&other == &rated || other.log_posterior < rated.log_posterior - kProbable) continue;
    const std::string& object = other.proposal.channel.object;
    const simulation::Expression expression = other.proposal.expression();
    if (TermOfChannel(object, expression) ==
        TermOfChannel(next.term().object, next.term().expression))
      continue;
    next.rivals.push_back(TermOfChannel(object, expression));
    const bool is_alike =
        object == next.term().object || std::ranges::find(next.alike, object) != next.alike.end();
    auto others = expression.Variables(), own = variables;
    std::ranges::sort(others);
    std::ranges::sort(own);
    if (is_alike && others == own) continue;
    next.doubts = {"other stages or variables are nearly as probable"};
  }
}

// What may come next, the most probable first: expressions near the best one, and where it is more
// probable, or alone asked for, the smooth function.
std::vector<Learned> Learner::Proposed(const TermSearch& search, bool only_smooth,
                                       const Fit& fit) const {
  constexpr std::size_t kFitted = 3;
  constexpr double kNear = 12.0;  // in log odds
  std::vector<Learned> proposed;
  const double best = search.best.empty() ? 0.0 : search.best.front().log_posterior;
  const double smooth = search.smooth ? search.log_posterior_of_smooth : 0.0;
  const auto add_smooth = [&] {
    proposed.push_back(Prepared(SmoothTermOf(fit, *search.smooth), true, search.smooth->drawn.sd));
  };
  if (smooth > kProbable && (only_smooth || smooth > best)) add_smooth();
  if (only_smooth) return proposed;
  for (const Rated& rated : search.best) {
    const bool is_near = rated.log_posterior > std::max(best - kNear, kProbable);
    if (!is_near || proposed.size() == kFitted) break;
    Learned next = Prepared(TermOf(fit, rated), false, 0.0);
    if (ImitatedByRows(fit, next.term(), rated.chi_square) > kHardlyLeft) continue;
    next.alike = rated.alike;
    AddRivals(search, rated, next);
    proposed.push_back(std::move(next));
  }
  return proposed;
}

// Takes the first proposal beside which nothing is left; where there is none, the first of all.
bool Learner::TakeNext(bool only_smooth, Step& step) {
  // The first search is the same for both ways.
  if (!step.terms.empty() || searches_.empty()) {
    searches_.push_back(
        std::make_unique<const TermSearch>(SearchTerms(*step.fit, step.structures)));
  }
  const TermSearch& search = step.terms.empty() ? *searches_.front() : *searches_.back();
  std::optional<Step> taken;
  for (Learned& next : Proposed(search, only_smooth, *step.fit)) {
    if (diagnosis::IsAmong(With(causes_, step.terms), next.candidate)) continue;
    Step tried{nullptr, step.terms, {}, {}, step.searches};
    tried.terms.push_back(std::move(next));
    tried.fit = Fitted(start_, With(causes_, tried.terms));
    if (!tried.fit) continue;
    tried.searches.push_back(&search);
    tried.structures = diagnosis::FindStructures(*tried.fit);
    tried.left = LeftBeside(*tried.fit, tried.structures);
    const bool is_all = tried.left.empty();
    if (is_all || !taken) taken = std::move(tried);
    if (is_all) break;
  }
  if (!taken) return false;
  step = std::move(*taken);
  return true;
}

Step Learner::Run(bool only_smooth) {
  Step step{start_, {}, {}, diagnosis::FindStructures(*start_), {}};
  step.left = LeftBeside(*start_, step.structures);
  const std::size_t most = only_smooth ? kMostSmooth : kMostTerms;
  Steps steps(1);
  do {
    steps.Begin("a term");
  } while (!step.left.empty() && step.terms.size() < most && TakeNext(only_smooth, step));
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

// Terms beside which something is left get no certificate: they do not count as found.
void Certify(const Learner& learner, const Step& step, Learning& learning) {
  if (!learning.left.empty()) {
    learning.terms = step.terms;
    return;
  }
  const std::vector<Candidate> named = NamedBeside(*learner.base(), learner.causes());
  for (std::size_t i = 0; i < step.terms.size(); ++i) {
    Learned learned = step.terms[i];
    const Confounding confounding =
        ConfoundingOf(*step.fit, learned.candidate, learned.term(), *learner.base(), named);
    LearnedTerm term = learned.term();
    term.certificate.by_chance = ByChance(*step.searches[i], learned.is_smooth);
    term.certificate.regime = RegimeOf(*step.fit, learned, learner.causes().size() + i);
    term.certificate.imitated = confounding.imitated;
    term.certificate.nearest = confounding.nearest;
    term.certificate.cosine = confounding.cosine;
    learned.group = confounding.group;
    learned.is_certified = true;
    if (!learned.group.empty()) {
      learned.doubts.push_back("a named cause can do the same");
    } else if (term.certificate.imitated > kImitated) {
      learned.doubts.push_back(
          fmt::format("parameters of the simulation can make {:.0f} % of its effect",
                      100.0 * term.certificate.imitated));
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
  if (step.terms.empty() && !learning.causes.empty()) {
    // Causes beside what is unexplained are doubtful: they may have taken a part of it.
    Learner alone(diagnosis.base, {});
    Step other = alone.Run(false);
    if (!other.terms.empty() && other.left.empty()) {
      learner = std::move(alone);
      step = std::move(other);
      learning.causes.clear();
    }
  }
  const auto is_smooth = [](const Learned& term) { return term.is_smooth; };
  if (!step.left.empty() && !std::ranges::all_of(step.terms, is_smooth)) {
    // An expression that leaves something is dropped; a smooth function may leave nothing.
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
  if (!learning.left.empty()) {
    for (Learned& learned : learning.terms) learned.doubts.push_back("something is left beside it");
    return;
  }
  std::vector<double> chances;
  for (const Learned& learned : learning.terms) {
    chances.push_back(learned.term().certificate.by_chance);
  }
  const double passing = LargestPassing(chances);
  bool all = true;
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
    learned.cause = LearnedCause::Of(std::move(term));
    all = all && learned.IsFound();
  }
  if (!all) return;
  if (learning.causes.empty()) std::erase_if(diagnosis.findings, diagnosis::IsModelled);
  diagnosis.verdict = diagnosis::Verdict::kLearned;
  diagnosis.leftovers.clear();
  diagnosis.chi_after = learning.chi_after;
}

}  // namespace abbe::learned
