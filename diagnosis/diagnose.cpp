#include "diagnosis/diagnose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "diagnosis/arm_baseline.h"
#include "diagnosis/line_search.h"
#include "diagnosis/scatter.h"
#include "failure/failure.h"
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"

namespace abbe::diagnosis {
namespace {

constexpr std::size_t kMostCauses = 6;
constexpr std::size_t kMostRefused = 24;  // between two that are taken in
constexpr double kNegligible = 0.01;      // probability of a rival that is not worth a word
constexpr int kRefinements = 12;          // halvings of the step between shapes
constexpr double kClose = 6.0;      // in log evidence: candidates that the first order may confuse
constexpr double kWorthFits = 8.0;  // log evidence of the best below which nothing is taken in
constexpr std::size_t kMostFits = 4;

double LogSumOfExponentials(const std::vector<double>& logs) {
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double each : logs) sum += std::exp(each - most);
  return most + std::log(sum);
}

// Neighbouring shapes in the list that was tried, as a factor.
double StepOf(const std::vector<Score>& scores, std::size_t first, std::size_t last,
              std::size_t best) {
  const std::size_t other = best + 1 < last ? best + 1 : best - 1;
  if (other < first || other == best) return 1.0;
  const double ratio = scores[other].candidate.shape[0] / scores[best].candidate.shape[0];
  return ratio > 1.0 ? ratio : 1.0 / ratio;
}

// A cause at an object: the best of its shapes, and the evidence of all of them together.
struct Named {
  Score best;
  double log_evidence = 0.0;
  double step = 1.0;  // from the best shape to the next one tried, a factor
};

std::vector<Named> ByName(const std::vector<Score>& scores) {
  std::vector<Named> names;
  for (std::size_t first = 0; first < scores.size();) {
    std::size_t last = first, best = first;
    std::vector<double> logs;
    const std::string name = scores[first].candidate.Name();
    for (; last < scores.size() && scores[last].candidate.Name() == name; ++last) {
      logs.push_back(scores[last].log_evidence);
      if (logs.back() > scores[best].log_evidence) best = last;
    }
    const double mean = LogSumOfExponentials(logs) - std::log(static_cast<double>(logs.size()));
    double visible = 0.0;
    for (std::size_t i = first; i < last; ++i) visible = std::max(visible, scores[i].visible);
    Named named{scores[best], mean, last - first > 1 ? StepOf(scores, first, last, best) : 1.0};
    named.best.visible = visible;
    names.push_back(std::move(named));
    first = last;
  }
  return names;
}

// Of a cause that is a line: its strongest one.
void FindLine(const Fit& fit, Named& named) {
  if (!named.best.candidate.cause->line_in) return;
  const double visible = named.best.visible;
  const Line line = StrongestLine(fit, named.best.candidate);
  named.best = line.score;
  named.best.visible = std::max(visible, line.score.visible);
  named.log_evidence = line.score.log_evidence - std::log(line.among);
  named.step = 1.0 + line.step / line.score.candidate.shape[0];
}

const Score& Better(const Score& one, const Score& other) {
  return other.log_evidence > one.log_evidence ? other : one;
}

// The shape with the largest evidence near the best one that was tried.
Score Refine(const Fit& fit, const Named& named) {
  Score best = named.best;
  const simulation::Cause& cause = *best.candidate.cause;
  const auto ask = [&](const std::vector<Candidate>& candidates) {
    for (const Score& score : ScoreAll(fit, candidates)) best = Better(best, score);
    best.visible = named.best.visible;
  };
  if (cause.nearer) {
    std::vector<Candidate> near;
    for (const auto& shape : cause.nearer(fit.campaign().scene(), best.candidate.shape)) {
      near.push_back(best.candidate);
      near.back().shape = shape;
    }
    ask(near);
  }
  if (best.candidate.shape.size() == 0 || cause.fixed_shapes) return best;
  double step = std::sqrt(named.step);
  for (int i = 0; i < kRefinements; ++i, step = std::sqrt(step)) {
    std::vector<Candidate> moved(2, best.candidate);
    moved[0].shape *= step;
    moved[1].shape /= step;
    ask(moved);
  }
  return best;
}

bool Known(const std::vector<Candidate>& taken, const Candidate& candidate) {
  return std::any_of(taken.begin(), taken.end(),
                     [&](const Candidate& other) { return other.Name() == candidate.Name(); });
}

// Log odds that a cause is there, before any data.
double LogPrior(std::size_t names) { return std::log(kPresent / static_cast<double>(names)); }

// Of a cause that is there or not: the evidence if it could be there by a part.
double EvidenceOfAPart(const Score& score) {
  const double information = score.visible * score.visible;
  const double along = score.log_evidence + 0.5 * information;
  return along > 0.0 && information > 0.0 ? 0.5 * along * along / information : 0.0;
}

class Search {
 public:
  explicit Search(const Campaign& campaign)
      : candidates_(
            AllCandidates(campaign.scene(), CoarsenessOf(campaign.setup().machine.population))),
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
      diagnosis_.findings[i].score = fit_->ScoreOf(i);
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
    std::vector<Named> names = ByName(ScoreAll(*fit_, candidates_));
    for (Named& named : names) FindLine(*fit_, named);
    SortByEvidence(names);
    if (diagnosis_.evidence.empty()) DescribeFirstRound(names);
    if (rim_sensors_ > 0) NoteShown(names);
    std::erase_if(names, [&](const Named& named) {
      return Known(taken_, named.best.candidate) || Known(refused_, named.best.candidate);
    });
    DecideByFits(names);
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
    const auto fit = FitWith(more);
    if (!fit || !Predicts(*fit)) {
      refused_.push_back(more.back());
      return refused_.size() < (fit ? kMostRefused : kMostCauses);
    }
    if (OfArms()) refused_.clear();  // it may have stood in the way
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
    if (!OfArms() || fit_->chi_square() < kNoiseIsKnown * kNoiseIsKnown * rows) return true;
    if (fit.left_out() > kBetter * fit_->left_out()) return false;
    return !fit.taken_in().back().cause->one_event || fit.chi_square() < kAll * rows;
  }

  // Where the first order cannot tell, fits with each of the leading candidates decide: what is
  // there or not is too large for it, and rivals are too near to each other.
  void DecideByFits(std::vector<Named>& names) const {
    if (names.empty()) return;
    const bool whole = names.front().best.candidate.cause->whole;
    const double best = names.front().log_evidence;
    std::vector<Named*> leading;
    for (Named& named : names) {
      const bool of_whole = named.best.candidate.cause->whole;
      const bool like_it = whole ? of_whole && named.log_evidence > 0.0
                                 : named.log_evidence > best - kClose ||
                                       (of_whole && EvidenceOfAPart(named.best) > kWorthFits);
      if (like_it && leading.size() < kMostFits) leading.push_back(&named);
    }
    if (best < kWorthFits || leading.size() < 2) return;
    double most = 0.0;
    for (Named* named : leading) {
      std::vector<Candidate> with = taken_;
      with.push_back(Refine(*fit_, *named).candidate);
      const auto fit = FitWith(with);
      named->log_evidence = fit ? fit->log_likelihood() - fit_->log_likelihood() : 0.0;
      most = std::max(most, named->log_evidence);
    }
    for (Named& named : names) {
      if (std::find(leading.begin(), leading.end(), &named) != leading.end()) continue;
      named.log_evidence = std::min(named.log_evidence, most - kClose);
    }
    SortByEvidence(names);
  }

  static void SortByEvidence(std::vector<Named>& names) {
    std::sort(names.begin(), names.end(),
              [](const Named& a, const Named& b) { return a.log_evidence > b.log_evidence; });
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
    for (const BadData& bad : fit_->campaign().bad_data()) {
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

  // A cause that the later ones explain as well is taken out again.
  void DropSuperfluous() {
    for (std::size_t i = 0; taken_.size() > 1 && i < taken_.size();) {
      std::vector<Candidate> others = taken_;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      auto without = FitWith(others);
      if (!without ||
          ScoreAll(*without, {taken_[i]}).front().log_evidence > -LogPrior(candidates_.size())) {
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
  Diagnosis diagnosis_;
};

}  // namespace

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
  if (!campaign.HasArms()) return Search(campaign).Run();
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
