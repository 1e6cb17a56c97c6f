#include "diagnosis/alias_group.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/evidence.h"
#include "diagnosis/line_search.h"
#include "standards/coverage.h"

namespace abbe::diagnosis {
namespace {

constexpr std::size_t kMostTried = 64;

double ShapeOf(const Score& score) { return score.candidate.shape[0]; }

// Shapes beside that of the score.
std::vector<Candidate> Tried(const Fit& without, const Candidate& found) {
  std::vector<Candidate> tried;
  if (found.cause->wave) {
    tried = LinesThatStandOut(without, found, kMostTried);
  } else {
    for (const Eigen::VectorXd& shape : found.cause->shapes(without.campaign().scene())) {
      tried.push_back(found);
      tried.back().shape = shape;
    }
  }
  std::erase_if(tried, [&](const Candidate& other) { return other.shape == found.shape; });
  return tried;
}

// In log evidence: what hardly decides between two, and what the first order leaves out: of a step,
// which is linear in its one size, hardly anything.
double NearlyAsGood(const Score& best) {
  constexpr double kHundredToOne = 4.6, kLeftOut = 0.02, kLeftOutOfAStep = 0.001;
  const double left_out = best.candidate.cause->one_event ? kLeftOutOfAStep : kLeftOut;
  return kHundredToOne + left_out * std::max(best.log_evidence, 0.0);
}

// Two standard deviations of the logarithm of the shape reach as far as this.
void Reach(Score& score, double logarithm) {
  const Eigen::Index last = score.covariance.rows() - 1;
  const double more = std::pow(logarithm / standards::kCoverage, 2) - score.covariance(last, last);
  if (more > 0.0) score.covariance(last, last) += more;
}

}  // namespace

bool MayHaveAliases(const Score& score) {
  const simulation::Cause& cause = *score.candidate.cause;
  return cause.wave || (cause.shapes && cause.fixed_shapes && score.candidate.shape.size() == 1 &&
                        !cause.IsRandomField());
}

Score AmongAliases(const Fit& without, Score score) {
  std::vector<Candidate> tried = Tried(without, score.candidate);
  tried.push_back(score.candidate);
  std::vector<Score> scores = ScoreAll(without, tried);
  const Score& winner = *std::ranges::max_element(scores, {}, &Score::log_evidence);
  const double least = winner.log_evidence - NearlyAsGood(winner);
  std::rotate(scores.begin(), scores.end() - 1, scores.end());  // the one found goes first
  std::stable_sort(scores.begin() + 1, scores.end(),
                   [](const Score& a, const Score& b) { return a.log_evidence > b.log_evidence; });
  const auto resolved = ResolvedBy(without, score.candidate);
  const auto waves = [&](const Score& each) {
    const auto& wave = score.candidate.cause->wave;
    return wave ? wave->WavesOf(ShapeOf(each)) : ShapeOf(each);
  };
  std::vector<Score> group;
  for (Score& each : scores) {
    if (!group.empty() && each.log_evidence < least) continue;
    const auto is_near = [&](const Score& other) {
      return std::abs(waves(other) - waves(each)) < resolved;
    };
    const auto near = std::ranges::find_if(group, is_near);
    if (near == group.end()) {
      group.push_back(std::move(each));
    } else if (near == group.begin() && score.candidate.HasFreeShape()) {
      Reach(score, std::log(ShapeOf(each) / ShapeOf(score)));
    }
  }
  if (group.size() > 1) score.one_of = std::move(group);
  return score;
}

}  // namespace abbe::diagnosis
