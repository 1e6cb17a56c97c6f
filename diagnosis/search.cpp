#include "diagnosis/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "diagnosis/leftovers.h"
#include "diagnosis/scatter.h"
#include "diagnosis/standing_pairs.h"
#include "diagnosis/structure_search.h"
#include "failure/failure.h"
#include "failure/progress.h"
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"
#include "simulation/excess_noise.h"

namespace abbe::diagnosis {
namespace {

constexpr std::size_t kMostCauses = 6;
constexpr std::size_t kMostElse = 4;
constexpr std::size_t kMostRefused = 24;  // between two that are taken in
constexpr double kClose = 6.0;      // in log evidence: candidates that the first order may confuse
constexpr double kWorthFits = 8.0;  // log evidence of the best below which nothing is taken in
constexpr std::size_t kMostFits = 4;

// Log odds that a cause is there, before any data.
double LogPrior(std::size_t names) { return std::log(kPresent / names); }

std::vector<double> ProbabilitiesOf(std::vector<double> logs) {
  const double all = LogSumOfExponentials(logs);
  for (double& each : logs) each = std::exp(each - all);
  return logs;
}

// Whether a swap or a wrong sign of channels could be taken for it.
bool InReadings(const Candidate& candidate) {
  using Kind = simulation::Object::Kind;
  const simulation::Object& object = candidate.object;
  return object.kind() == Kind::kProbe || object.kind() == Kind::kProbePair ||
         object == "target_top" || object == "target_side";
}

// Whether what was taken in last would have to be of a size that nothing of its kind has.
bool IsImpossible(const Fit& fit) {
  return BeyondBounds(fit.ScoreOf(fit.taken_in().size() - 1)) != nullptr;
}

}  // namespace

Search::Search(const Campaign& campaign)
    : candidates_(CandidatesOf(campaign)),
      rim_sensors_(simulation::RimSensorsOf(campaign.scene()).size()),
      base_(std::make_shared<const Fit>(campaign)),
      fit_(base_) {}

Diagnosis Search::Run() {
  diagnosis_.chi_before = fit_->chi_square() / fit_->rows();
  // Each sensor at a shaft may have a gain and a characteristic of its own.
  Steps steps(2);
  do {
    steps.Begin(fmt::format("cause {}", members_.size() + 1));
  } while (CausesTaken() < kMostCauses + 2 * rim_sensors_ && TakeBest());
  steps.Begin("leaving out each cause");
  DropSuperfluous();
  if (rim_sensors_ > 0) ForgiveRivalsFound();
  Describe();
  return std::move(diagnosis_);
}

double Search::LogOddsOfFirst() {
  ScoreRound();
  const std::vector<double> logs = LogOdds(shortlist_);
  return std::max(*std::ranges::max_element(logs), LogOddsOfSomethingElse());
}

// Scores everything against the fit so far.
void Search::ScoreRound() {
  if (shortlist_.empty()) shortlist_ = Shortlist(*fit_, candidates_);
  if (diagnosis_.evidence.empty()) DescribeFirstRound(shortlist_);
  if (rim_sensors_ > 0) NoteShown(shortlist_);
  // What no model of an arm reaches is in its noise, and a cause has to predict there.
  if (structures_.empty() && !(fit_->left_out() > 0.0)) {
    structures_ = FindStructures(*fit_);
    other_ = MostProbable(*fit_, structures_);
  }
}

std::vector<Named> Search::NamesLeft() const {
  std::vector<Named> names = shortlist_;
  const std::vector<Candidate> taken = Taken();
  std::erase_if(names, [&](const Named& named) {
    return IsAmong(taken, named.best.candidate) || IsAmong(refused_, named.best.candidate);
  });
  return names;
}

// False when nothing is probable enough.
bool Search::TakeBest() {
  ScoreRound();
  std::vector<Named> names = NamesLeft();
  FitPointer decided = MayOutweigh(names) ? DecideByFits(names) : nullptr;
  std::vector<double> logs = LogOdds(names);
  logs.push_back(LogOddsOfSomethingElse());
  if (ProbabilitiesOf(logs).front() > 1.0 - kCertain) return false;
  if (other_ && !Outweighs(names, decided)) {
    return members_.size() - CausesTaken() < kMostElse && TakeSomethingElse(*other_);
  }
  return TakeCause(names, std::move(decided));
}

// That nothing more is there (0), then of each name.
std::vector<double> Search::LogOdds(const std::vector<Named>& names) const {
  std::vector<double> logs{0.0};
  for (const Named& named : names) logs.push_back(named.log_evidence + LogPrior(names.size()));
  return logs;
}

double Search::LogOddsOfSomethingElse() const {
  return other_ ? LogPosterior(*other_, structures_.size())
                : -std::numeric_limits<double>::infinity();
}

bool Search::TakeCause(const std::vector<Named>& names, FitPointer decided) {
  const std::vector<double> logs = LogOdds(names);
  const std::vector<double> probabilities = ProbabilitiesOf(logs);
  Finding finding{Refine(*fit_, names.front()), probabilities[1], {}};
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (probabilities[i + 1] > kNegligible) {
      const Score& other = names[i].best;
      finding.rivals.push_back({other.candidate, probabilities[i + 1], other.coefficients});
    }
  }
  finding.something_else = ProbabilityOf(LogOddsOfSomethingElse() - LogSumOfExponentials(logs));
  std::vector<Candidate> more = Taken();
  more.push_back(finding.score.candidate);
  const auto fit = decided ? std::move(decided) : FitWith(more);
  if (!fit || !Predicts(*fit) || IsImpossible(*fit)) {
    refused_.push_back(more.back());
    return refused_.size() < (fit ? kMostRefused : kMostCauses);
  }
  return TakeIn({.finding = std::move(finding), .log_prior = LogPrior(names.size())}, fit);
}

bool Search::TakeSomethingElse(Found found) {
  const std::size_t questions = structures_.size();
  AddThoseAlike(*fit_, structures_, found);
  Member member{.finding = {{others_.CandidateOf(found), {}, {}}, 1.0, {}},
                .other = found,
                .unexplained = LeftoverOf(*fit_, found, questions),
                .log_prior = std::log(kElse / questions)};
  std::vector<Candidate> more = Taken();
  more.push_back(member.finding.score.candidate);
  constexpr int kRounds = 2;  // the next fits go on from there
  const auto fit = FitWith(more, kRounds);
  return fit && TakeIn(std::move(member), fit);
}

bool Search::TakeIn(Member member, FitPointer fit) {
  refused_.clear();  // it may have stood in the way
  shortlist_.clear();
  structures_.clear();
  by_fits_.clear();
  members_.push_back(std::move(member));
  fit_ = std::move(fit);
  return true;
}

// Whether some cause may be more probable than something else once it is fitted in full: to first
// order a large one is worth less than it is.
bool Search::MayOutweigh(const std::vector<Named>& names) const {
  constexpr double kWorthATry = 0.5;
  return !other_ || std::ranges::any_of(names, [&](const Named& named) {
    const double worth =
        named.best.candidate.cause->IsBinary() ? EvidenceOfAPart(named.best) : named.log_evidence;
    return worth > kWorthATry * other_->drawn.log_evidence;
  });
}

// Whether the best cause goes first: it is more probable than something else, or explains most of
// what that does, and something else may follow.
bool Search::Outweighs(std::vector<Named>& names, FitPointer& fitted) const {
  constexpr double kMostOfIt = 0.75;
  if (names.empty()) return false;
  double& log_evidence = names.front().log_evidence;
  const double other = std::min(LogOddsOfSomethingElse() - LogPrior(names.size()),
                                std::max(kWorthFits, kMostOfIt * other_->drawn.log_evidence));
  if (log_evidence > other || log_evidence < kWorthFits || !MayOutweigh(names)) {
    return log_evidence > other;
  }
  if (!fitted) {
    std::vector<Candidate> with = Taken();
    with.push_back(Refine(*fit_, names.front()).candidate);
    fitted = FitWith(with);
  }
  if (fitted) log_evidence = fitted->log_likelihood() - fit_->log_likelihood();
  return log_evidence > other;
}

// What is left of an arm is no white noise while more than its noise is left, and evidence counts
// each row as if it were: then a cause has to predict the poses of an arm that took no part; a
// step at an instant of its own, which fits any drift, has to explain all that is left.
bool Search::Predicts(const Fit& fit) const {
  constexpr double kBetter = 0.9, kAll = 1.5;  // of chi-square
  const double rows = fit.rows();
  if (!(fit_->left_out() > 0.0) ||
      fit_->chi_square() < simulation::kNoiseIsKnown * simulation::kNoiseIsKnown * rows)
    return true;
  if (fit.left_out() > kBetter * fit_->left_out()) return false;
  return !fit.taken_in().back().cause->one_event || fit.chi_square() < kAll * rows;
}

// Where the first order cannot tell, fits with each of the leading candidates decide: what is
// there or not is too large for it, and rivals are too near to each other. The fit with the best
// of them, if there was one.
Search::FitPointer Search::DecideByFits(std::vector<Named>& names) {
  if (names.empty()) return nullptr;
  const bool whole = names.front().best.candidate.cause->IsBinary();
  const bool in_readings = InReadings(names.front().best.candidate);
  const double best = names.front().log_evidence;
  std::vector<Named*> leading;
  for (Named& named : names) {
    const bool of_whole = named.best.candidate.cause->IsBinary();
    const bool like_it =
        whole ? of_whole && named.log_evidence > 0.0
              : named.log_evidence > best - kClose ||
                    (of_whole && in_readings && EvidenceOfAPart(named.best) > kWorthFits);
    if (like_it && leading.size() < kMostFits) leading.push_back(&named);
  }
  if (best < kWorthFits || leading.size() < 2) return nullptr;
  double most = 0.0;
  FitPointer of_most;
  for (Named* named : leading) {
    const auto [known, is_new] = by_fits_.try_emplace(named->best.candidate.Name(), 0.0);
    FitPointer fit;
    if (is_new) {
      std::vector<Candidate> with = Taken();
      with.push_back(Refine(*fit_, *named).candidate);
      fit = FitWith(with);
      if (fit && !IsImpossible(*fit)) {
        known->second = fit->log_likelihood() - fit_->log_likelihood();
      }
    }
    named->log_evidence = known->second;
    if (named->log_evidence > most) of_most = std::move(fit);
    most = std::max(most, named->log_evidence);
  }
  for (Named& named : names) {
    if (std::find(leading.begin(), leading.end(), &named) != leading.end()) continue;
    named.log_evidence = std::min(named.log_evidence, most - kClose);
  }
  SortByEvidence(names);
  return of_most;
}

// None where the simulation cannot be fitted with these: what they explain to first order, they
// do not explain.
Search::FitPointer Search::FitWith(const std::vector<Candidate>& taken, int rounds) const {
  try {
    return std::make_shared<const Fit>(*fit_, taken, rounds);
  } catch (const NumericalError&) {
    return nullptr;
  }
}

std::vector<Candidate> Search::Taken() const {
  std::vector<Candidate> taken;
  taken.reserve(members_.size());
  for (const Member& member : members_) taken.push_back(member.finding.score.candidate);
  return taken;
}

std::vector<Candidate> Search::Others(std::size_t than) const {
  std::vector<Candidate> others = Taken();
  others.erase(others.begin() + than);
  return others;
}

std::size_t Search::CausesTaken() const {
  return std::ranges::count_if(members_, [](const Member& member) { return !member.other; });
}

void Search::DescribeFirstRound(const std::vector<Named>& names) {
  for (const Named& named : names) {
    diagnosis_.evidence.push_back(named.best);
    diagnosis_.evidence.back().log_evidence = named.log_evidence;
    if (named.best.visible < kShowable) {
      diagnosis_.cannot_show.push_back(named.best.candidate.Name());
    }
  }
  for (std::string& name : StandingPairs(fit_->campaign().scene())) {
    diagnosis_.cannot_show.push_back(std::move(name));
  }
  std::sort(diagnosis_.cannot_show.begin(), diagnosis_.cannot_show.end());
}

// Gain and characteristic of a sensor show once an eccentricity is known to move its gap.
void Search::NoteShown(const std::vector<Named>& names) {
  std::erase_if(diagnosis_.cannot_show, [&](const std::string& hidden) {
    return std::any_of(names.begin(), names.end(), [&](const Named& named) {
      return named.best.visible >= kShowable && named.best.candidate.Name() == hidden;
    });
  });
}

}  // namespace abbe::diagnosis
