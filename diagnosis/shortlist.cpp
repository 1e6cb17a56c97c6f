#include "diagnosis/shortlist.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/evidence.h"
#include "diagnosis/line_search.h"
#include "estimation/in_parallel.h"

namespace abbe::diagnosis {
namespace {

constexpr int kRefinements = 12;  // halvings of the step between shapes

// Neighbouring shapes in the list that was tried, as a factor.
double StepOf(const std::vector<Score>& scores, std::size_t first, std::size_t last,
              std::size_t best) {
  const std::size_t other = best + 1 < last ? best + 1 : best - 1;
  if (other < first || other == best) return 1.0;
  const double ratio = scores[other].candidate.shape[0] / scores[best].candidate.shape[0];
  return ratio > 1.0 ? ratio : 1.0 / ratio;
}

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
    const double mean = LogSumOfExponentials(logs) - std::log(logs.size());
    double visible = 0.0;
    for (std::size_t i = first; i < last; ++i) visible = std::max(visible, scores[i].visible);
    Named named{scores[best], mean, last - first > 1 ? StepOf(scores, first, last, best) : 1.0};
    named.best.visible = visible;
    names.push_back(std::move(named));
    first = last;
  }
  return names;
}

// The strongest wave of a cause that is one: half of the prior is that of the shapes tried one by
// one, half that of all others.
void FindLine(const Fit& fit, Named& named) {
  if (!named.best.candidate.cause->wave) return;
  const Line line = StrongestLine(fit, named.best.candidate);
  named.log_evidence =
      LogSumOfExponentials({named.log_evidence, line.score.log_evidence - std::log(line.among)}) -
      std::log(2.0);
  if (line.score.candidate.shape == named.best.candidate.shape) return;
  const double visible = named.best.visible;
  named.best = line.score;
  named.best.visible = std::max(visible, line.score.visible);
  named.step = line.step;
}

const Score& Better(const Score& one, const Score& other) {
  return other.log_evidence > one.log_evidence ? other : one;
}

}  // namespace

double LogSumOfExponentials(const std::vector<double>& logs) {
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double each : logs) sum += std::exp(each - most);
  return most + std::log(sum);
}

std::vector<Named> Shortlist(const Fit& fit, const std::vector<Candidate>& candidates) {
  std::vector<Named> names = ByName(ScoreAll(fit, candidates));
  estimation::InParallel(names.size(), [&](std::size_t i) { FindLine(fit, names[i]); });
  SortByEvidence(names);
  return names;
}

void SortByEvidence(std::vector<Named>& names) {
  std::sort(names.begin(), names.end(),
            [](const Named& a, const Named& b) { return a.log_evidence > b.log_evidence; });
}

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

double EvidenceOfAPart(const Score& score) {
  const double information = score.visible * score.visible;
  const double along = score.log_evidence + 0.5 * information;
  return along > 0.0 && information > 0.0 ? 0.5 * along * along / information : 0.0;
}

double ProbabilityOf(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

}  // namespace abbe::diagnosis
