#include "diagnosis/diagnose.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "diagnosis/scatter.h"
#include "diagnosis/shape_posterior.h"
#include "diagnosis/shortlist.h"
#include "diagnosis/standing_pairs.h"
#include "failure/failure.h"
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"
#include "simulation/excess_noise.h"

namespace abbe::diagnosis {
namespace {

constexpr std::size_t kMostCauses = 6;
constexpr std::size_t kMostRefused = 24;  // between two that are taken in
constexpr double kNegligible = 0.01;      // probability of a rival that is not worth a word
constexpr double kClose = 6.0;      // in log evidence: candidates that the first order may confuse
constexpr double kWorthFits = 8.0;  // log evidence of the best below which nothing is taken in
constexpr std::size_t kMostFits = 4;

bool Known(const std::vector<Candidate>& taken, const Candidate& candidate) {
  return std::any_of(taken.begin(), taken.end(),
                     [&](const Candidate& other) { return other.Name() == candidate.Name(); });
}

// Log odds that a cause is there, before any data.
double LogPrior(std::size_t names) { return std::log(kPresent / static_cast<double>(names)); }

// Whether a swap or a wrong sign of channels could be taken for it.
bool InReadings(const Candidate& candidate) {
  using Kind = simulation::Object::Kind;
  const simulation::Object& object = candidate.object;
  return object.kind() == Kind::kProbe || object.kind() == Kind::kProbePair ||
         object == "target_top" || object == "target_side";
}

class Search {
 public:
  explicit Search(const Campaign& campaign)
      : candidates_(AllCandidates(campaign.scene(),
                                  CoarsenessOf(campaign.instruments().machine.population))),
        rim_sensors_(simulation::RimSensorsOf(campaign.scene()).size()),
        base_(std::make_shared<const Fit>(campaign)),
        fit_(base_) {}

  Diagnosis Run() {
    diagnosis_.chi_before = fit_->chi_square() / static_cast<double>(fit_->rows());
    // Each sensor at a shaft may have a gain and a characteristic of its own.
    while (taken_.size() < kMostCauses + 2 * rim_sensors_ && TakeBest()) {
    }
    DropSuperfluous();
    if (rim_sensors_ > 0) ForgiveRivalsFound();
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      const double visible = diagnosis_.findings[i].score.visible;
      const double log_evidence = diagnosis_.findings[i].score.log_evidence;
      diagnosis_.findings[i].score = ScoreOf(i);
      diagnosis_.findings[i].score.visible = visible;
      diagnosis_.findings[i].score.log_evidence = log_evidence;
      diagnosis_.findings[i].curve = CurveOf(*base_, *fit_, i);
    }
    diagnosis_.map_change = MapChange(*base_, *fit_);
    // What was found was shown after all.
    std::erase_if(diagnosis_.cannot_show, [&](const std::string& name) {
      return std::any_of(taken_.begin(), taken_.end(),
                         [&](const Candidate& cause) { return cause.Name() == name; });
    });
    AddBadData();
    diagnosis_.leftovers = FindLeftovers(*fit_);
    for (Leftover& run : RunsThatScatter(*fit_)) diagnosis_.leftovers.push_back(std::move(run));
    diagnosis_.chi_after = fit_->chi_square() / static_cast<double>(fit_->rows());
    diagnosis_.verdict = VerdictOf(diagnosis_);
    diagnosis_.fitted = fit_->result();
    return std::move(diagnosis_);
  }

  const Fit& fit() const { return *fit_; }

 private:
  // Scores everything against the fit so far; false when nothing is probable enough.
  bool TakeBest() {
    if (shortlist_.empty()) shortlist_ = Shortlist(*fit_, candidates_);
    std::vector<Named> names = shortlist_;
    if (diagnosis_.evidence.empty()) DescribeFirstRound(names);
    if (rim_sensors_ > 0) NoteShown(names);
    std::erase_if(names, [&](const Named& named) {
      return Known(taken_, named.best.candidate) || Known(refused_, named.best.candidate);
    });
    std::shared_ptr<const Fit> decided = DecideByFits(names);
    const double prior = LogPrior(names.size());
    std::vector<double> logs{0.0};  // nothing more
    for (const Named& named : names) logs.push_back(named.log_evidence + prior);
    const double all = LogSumOfExponentials(logs);
    if (std::exp(logs.front() - all) > 1.0 - kCertain) return false;
    Finding finding{Refine(*fit_, names.front()), std::exp(logs[1] - all), {}};
    for (std::size_t i = 1; i < names.size(); ++i) {
      const double probability = std::exp(logs[i + 1] - all);
      if (probability > kNegligible) {
        const Score& other = names[i].best;
        finding.rivals.push_back({other.candidate, probability, other.coefficients});
      }
    }
    std::vector<Candidate> more = taken_;
    more.push_back(finding.score.candidate);
    const auto fit = decided ? std::move(decided) : FitWith(more);
    if (!fit || !Predicts(*fit)) {
      refused_.push_back(more.back());
      return refused_.size() < (fit ? kMostRefused : kMostCauses);
    }
    refused_.clear();  // it may have stood in the way
    shortlist_.clear();
    by_fits_.clear();
    taken_ = std::move(more);
    diagnosis_.findings.push_back(std::move(finding));
    fit_ = fit;
    return true;
  }

  bool OfArms() const { return fit_->left_out() > 0.0; }

  // What is left of an arm is no white noise while more than its noise is left, and evidence counts
  // each row as if it were: then a cause has to predict the poses of an arm that took no part; a
  // step at an instant of its own, which fits any drift, has to explain all that is left.
  bool Predicts(const Fit& fit) const {
    constexpr double kBetter = 0.9, kAll = 1.5;  // of chi-square
    const auto rows = static_cast<double>(fit.rows());
    if (!OfArms() ||
        fit_->chi_square() < simulation::kNoiseIsKnown * simulation::kNoiseIsKnown * rows)
      return true;
    if (fit.left_out() > kBetter * fit_->left_out()) return false;
    return !fit.taken_in().back().cause->one_event || fit.chi_square() < kAll * rows;
  }

  // Where the first order cannot tell, fits with each of the leading candidates decide: what is
  // there or not is too large for it, and rivals are too near to each other. The fit with the best
  // of them, if there was one.
  std::shared_ptr<const Fit> DecideByFits(std::vector<Named>& names) {
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
    std::shared_ptr<const Fit> of_most;
    for (Named* named : leading) {
      const auto [known, is_new] = by_fits_.try_emplace(named->best.candidate.Name(), 0.0);
      std::shared_ptr<const Fit> fit;
      if (is_new) {
        std::vector<Candidate> with = taken_;
        with.push_back(Refine(*fit_, *named).candidate);
        fit = FitWith(with);
        if (fit) known->second = fit->log_likelihood() - fit_->log_likelihood();
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
  std::shared_ptr<const Fit> FitWith(const std::vector<Candidate>& causes) const {
    try {
      return std::make_shared<const Fit>(*fit_, causes);
    } catch (const NumericalError&) {
      return nullptr;
    }
  }

  // Found row by row, so certain.
  void AddBadData() {
    for (const InvalidReadings& bad : fit_->campaign().invalid_readings()) {
      const simulation::Cause& cause = simulation::CauseNamed(bad.cause);
      Finding finding{{{&cause, bad.object, {}}, {}, {}}, 1.0, {}};
      finding.score.coefficients =
          cause.coefficients() == 1 ? Eigen::VectorXd::Constant(1, static_cast<double>(bad.count))
                                    : Eigen::VectorXd(Eigen::Vector2d(bad.from, bad.to));
      finding.score.covariance = Eigen::MatrixXd::Zero(cause.coefficients(), cause.coefficients());
      diagnosis_.findings.push_back(std::move(finding));
    }
  }

  void DescribeFirstRound(const std::vector<Named>& names) {
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
  void NoteShown(const std::vector<Named>& names) {
    std::erase_if(diagnosis_.cannot_show, [&](const std::string& hidden) {
      return std::any_of(names.begin(), names.end(), [&](const Named& named) {
        return named.best.visible >= kShowable && named.best.candidate.Name() == hidden;
      });
    });
  }

  // Two sensors of unequal gain were rivals for who goes first; both are there.
  void ForgiveRivalsFound() {
    for (Finding& finding : diagnosis_.findings) {
      std::erase_if(finding.rivals, [&](const Rival& rival) {
        const bool found = rival.candidate.cause == finding.score.candidate.cause &&
                           Known(taken_, rival.candidate);
        if (found) finding.probability = std::min(1.0, finding.probability + rival.probability);
        return found;
      });
    }
  }

  std::vector<Candidate> Others(std::size_t than) const {
    std::vector<Candidate> others = taken_;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(than));
    return others;
  }

  Score ScoreOf(std::size_t i) const {
    Score score = fit_->ScoreOf(i);
    if (!IsHardlyKnown(score)) return score;
    const auto without = FitWith(Others(i));
    return without ? OverAllShapes(*without, std::move(score)) : score;
  }

  // Whether, all others at their best, so much of it is left that no fit without it is needed.
  bool IsBeyondDoubt(std::size_t i) const {
    constexpr double kBeyond = 400.0;  // squares of standard deviations
    if (taken_[i].cause->relaxes || taken_[i].cause->IsBinary()) return false;
    const Score score = fit_->ScoreOf(i);
    const Eigen::Index count = score.coefficients.size();
    const Eigen::MatrixXd covariance = score.covariance.topLeftCorner(count, count);
    return score.coefficients.dot(covariance.ldlt().solve(score.coefficients)) > kBeyond;
  }

  // What is there or not is too large for the first order.
  double EvidenceBeside(const Fit& without, std::size_t i) const {
    return taken_[i].cause->IsBinary() ? fit_->log_likelihood() - without.log_likelihood()
                                       : ScoreAll(without, {taken_[i]}).front().log_evidence;
  }

  // A cause that the later ones explain as well is taken out again.
  void DropSuperfluous() {
    for (std::size_t i = 0; taken_.size() > 1 && i < taken_.size();) {
      if (IsBeyondDoubt(i)) {
        ++i;
        continue;
      }
      std::vector<Candidate> others = Others(i);
      auto without = FitWith(others);
      if (!without || EvidenceBeside(*without, i) > -LogPrior(candidates_.size())) {
        ++i;
        continue;
      }
      taken_ = std::move(others);
      diagnosis_.findings.erase(diagnosis_.findings.begin() + static_cast<std::ptrdiff_t>(i));
      fit_ = std::move(without);
    }
  }

  static Verdict VerdictOf(const Diagnosis& diagnosis) {
    if (!diagnosis.leftovers.empty()) return Verdict::kUnexplained;
    if (diagnosis.findings.empty()) return Verdict::kClean;
    const bool certain =
        std::all_of(diagnosis.findings.begin(), diagnosis.findings.end(),
                    [](const Finding& finding) { return finding.probability >= kCertain; });
    return certain ? Verdict::kExplained : Verdict::kAmbiguous;
  }

  const std::vector<Candidate> candidates_;
  const std::size_t rim_sensors_;
  std::vector<Candidate> taken_, refused_;
  std::shared_ptr<const Fit> base_, fit_;
  std::vector<Named> shortlist_;           // beside those taken in
  std::map<std::string, double> by_fits_;  // log evidence, of those whose fits were made
  Diagnosis diagnosis_;
};

// How much larger than stated the noise of each run is; 1 where the stated one is believed.
std::vector<double> ExcessOf(const Fit& fit) {
  std::vector<double> excess;
  const auto& runs = fit.campaign().runs();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    excess.push_back(runs[r].EstimatesNoise() ? simulation::ExcessOf(fit.result().sources[r],
                                                                     fit.LeftOf(r), runs[r].excess)
                                              : 1.0);
  }
  return excess;
}

}  // namespace

bool IsModelled(const Finding& finding) {
  const simulation::Cause& cause = *finding.score.candidate.cause;
  return cause.columns || cause.relaxes;
}

std::string_view Name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kClean:
      return "clean";
    case Verdict::kExplained:
      return "explained";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kUnexplained:
      return "unexplained";
  }
  return "";
}

Diagnosis Diagnose(const Campaign& campaign) {
  if (!campaign.EstimatesNoise()) return Search(campaign).Run();
  Campaign noisy = campaign;
  // Runs that do not go together leave much more than each does alone.
  noisy.SetExcess(ExcessOf(Fit(noisy)), Campaign::Change::kUp);
  for (;;) {
    Search search(noisy);
    Diagnosis diagnosis = search.Run();
    // What was explained is noise of an arm no more: look again with what is left.
    if (!noisy.SetExcess(ExcessOf(search.fit()), Campaign::Change::kDown)) return diagnosis;
  }
}

}  // namespace abbe::diagnosis
