#include "diagnosis/next_run.h"

#include <algorithm>
#include <optional>

#include "diagnosis/expected_odds.h"
#include "diagnosis/linear_runs.h"
#include "diagnosis/run_catalogue.h"
#include "failure/failure.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool HasRivals(const Finding& finding) { return !finding.rivals.empty(); }

// What stands in the place of one finding, and the others, which may be there too.
struct Contest {
  std::vector<RivalWorld> rivals;
  std::vector<Candidate> candidates;  // the rivals, then the others
  Index rival_coefficients = 0;
  VectorXd plausible;  // of the others

  Contest(const Diagnosis& diagnosis, const Finding& finding) {
    const Score& found = finding.score;
    Enter({found.candidate, found.coefficients, finding.probability});
    for (const Rival& rival : finding.rivals) {
      Enter({rival.candidate, rival.coefficients, rival.probability});
    }
    for (const Finding& other : diagnosis.findings) {
      const simulation::Cause& cause = *other.score.candidate.cause;
      if (cause.IsBinary() || (!cause.columns && !cause.relaxes) || Known(other.score.candidate)) {
        continue;
      }
      candidates.push_back(other.score.candidate);
      plausible.conservativeResize(plausible.size() + cause.coefficients());
      plausible.tail(cause.coefficients()) = other.score.candidate.Plausible();
    }
  }

  void Enter(RivalWorld rival) {
    candidates.push_back(rival.candidate);
    rival_coefficients += rival.candidate.cause->coefficients();
    rivals.push_back(std::move(rival));
  }

  bool Known(const Candidate& candidate) const {
    return std::any_of(candidates.begin(), candidates.end(),
                       [&](const Candidate& other) { return other.Name() == candidate.Name(); });
  }
};

class Prospects {
 public:
  Prospects(const Campaign& campaign, std::vector<PossibleRun> possible, const Values& fitted)
      : possible_(std::move(possible)),
        recorded_(campaign.runs().size()),
        linear_(campaign, AllRuns(campaign), fitted) {}

  std::optional<NextRun> BestFor(const Contest& contest) const {
    std::vector<RunSums> recorded;
    recorded.reserve(recorded_);
    for (std::size_t run = 0; run < recorded_; ++run) {
      recorded.push_back(linear_.SumsOf(linear_.At(run), contest.candidates));
    }
    std::vector<const RunSums*> runs = PointersTo(recorded);
    const MatrixXd before = InformationOf(runs, contest);
    std::vector<NextRun> next;
    for (std::size_t i = 0; i < possible_.size(); ++i) {
      const std::optional<RunSums> more = SumsOf(recorded_ + i, contest);
      if (!more) continue;
      runs.push_back(&*more);
      next.push_back({possible_[i].text,
                      ExpectedProbability(before, InformationOf(runs, contest), contest.rivals),
                      possible_[i].seconds});
      runs.pop_back();
    }
    return Best(next, ExpectedProbability(before, before, contest.rivals));
  }

 private:
  std::vector<PreparedRun> AllRuns(const Campaign& campaign) const {
    std::vector<PreparedRun> runs = campaign.runs();
    for (const PossibleRun& possible : possible_) runs.push_back(possible.run);
    return runs;
  }

  // None where this machine cannot make the run.
  std::optional<RunSums> SumsOf(std::size_t run, const Contest& contest) const {
    try {
      return linear_.SumsOf(linear_.At(run), contest.candidates);
    } catch (const NumericalError&) {
      return {};
    }
  }

  MatrixXd InformationOf(const std::vector<const RunSums*>& runs, const Contest& contest) const {
    return FreeOfOthers(linear_.Information(runs), contest.rival_coefficients, contest.plausible);
  }

  static std::optional<NextRun> Best(std::vector<NextRun> next, double now) {
    constexpr double kLeastGain = 0.05;  // of probability
    std::sort(next.begin(), next.end(),
              [](const NextRun& a, const NextRun& b) { return a.seconds < b.seconds; });
    const auto certain = std::find_if(next.begin(), next.end(), [](const NextRun& run) {
      return run.expected_probability >= kCertain;
    });
    if (certain != next.end()) return *certain;
    const auto most =
        std::max_element(next.begin(), next.end(), [](const NextRun& a, const NextRun& b) {
          return a.expected_probability < b.expected_probability;
        });
    if (most == next.end() || most->expected_probability < now + kLeastGain) return {};
    return *most;
  }

  std::vector<PossibleRun> possible_;
  std::size_t recorded_;
  LinearRuns linear_;
};

}  // namespace

void AddNextRuns(const Campaign& campaign, const std::vector<recording::Recording>& recordings,
                 Diagnosis& diagnosis) {
  if (std::none_of(diagnosis.findings.begin(), diagnosis.findings.end(), HasRivals)) return;
  if (!campaign.instruments().HasAxes()) return;
  const Prospects prospects(campaign, PossibleRuns(campaign, recordings),
                            ValuesOf(diagnosis.fitted));
  for (Finding& finding : diagnosis.findings) {
    if (HasRivals(finding)) finding.next_run = prospects.BestFor(Contest(diagnosis, finding));
  }
}

}  // namespace abbe::diagnosis
