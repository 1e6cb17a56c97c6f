#include "diagnosis/line_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/evidence.h"

namespace abbe::diagnosis {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;

constexpr double kLowest = 1.0, kHighest = 60.0;  // Hz: slower is a drift, faster is mains
constexpr double kOfAWave = 0.4;                  // over the time, from one frequency to the next
constexpr std::size_t kMostPeaks = 8;             // of a run
constexpr Index kMostLineRows = 400;              // of a run, its first: more take longer
constexpr std::size_t kMostRuns = 4;              // looked through one by one
constexpr std::size_t kMostScored = 3;

// Rows of a stage, by time.
struct Rows {
  ArrayXd time, scores, weights;

  double span() const { return time.maxCoeff() - time.minCoeff(); }
};

struct Peak {
  double frequency, power;
};

bool AreSingleReadings(const simulation::Trace& trace) {
  if (!trace.averages_known) return false;
  return trace.samples.size() == 0 || (trace.samples.array() <= 1.0).all();
}

std::vector<Rows> RowsOf(const Fit& fit, Index stage) {
  std::vector<Rows> runs;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const simulation::Trace& trace = fit.TraceOf(run);
    if (trace.rows() < 3 || !AreSingleReadings(trace)) continue;
    const auto of_run = fit.ScoresOf(run, stage);
    if (of_run.scores.size() == 0 || !(of_run.weights.maxCoeff() > 0.0)) continue;
    const Index rows = std::min(trace.rows(), kMostLineRows);
    runs.push_back({trace.clock.head(rows).array(), of_run.scores.head(rows).transpose().array(),
                    of_run.weights.head(rows).transpose().array()});
  }
  std::sort(runs.begin(), runs.end(),
            [](const Rows& a, const Rows& b) { return a.weights.sum() > b.weights.sum(); });
  return runs;
}

Rows Together(const std::vector<Rows>& runs) {
  Rows all;
  for (const Rows& run : runs) {
    const Index n = all.time.size(), more = run.time.size();
    for (ArrayXd* values : {&all.time, &all.scores, &all.weights})
      values->conservativeResize(n + more);
    all.time.tail(more) = run.time;
    all.scores.tail(more) = run.scores;
    all.weights.tail(more) = run.weights;
  }
  return all;
}

// Chi-square of a line at evenly spaced frequencies, at most: what else could do the same is left
// out.
std::vector<Peak> PowersOf(const Rows& rows, double first, double last, double step) {
  const double turn = 2.0 * std::numbers::pi;
  ArrayXd cosine = (turn * first * rows.time).cos(), sine = (turn * first * rows.time).sin();
  const ArrayXd turned_cosine = (turn * step * rows.time).cos(),
                turned_sine = (turn * step * rows.time).sin();
  std::vector<Peak> powers;
  for (double frequency = first; frequency <= last; frequency += step) {
    const double by_sine = (rows.scores * sine).sum(), by_cosine = (rows.scores * cosine).sum();
    const double of_sine = (rows.weights * sine.square()).sum(),
                 of_cosine = (rows.weights * cosine.square()).sum();
    powers.push_back({frequency, by_sine * by_sine / std::max(of_sine, 1e-300) +
                                     by_cosine * by_cosine / std::max(of_cosine, 1e-300)});
    const ArrayXd before = cosine;
    cosine = before * turned_cosine - sine * turned_sine;
    sine = before * turned_sine + sine * turned_cosine;
  }
  return powers;
}

// Those that stand above their neighbours and above what chance makes among so many, the strongest
// first.
std::vector<Peak> PeaksOf(const std::vector<Peak>& powers) {
  const double chance = 2.0 * std::log(static_cast<double>(powers.size()));
  std::vector<Peak> peaks;
  for (std::size_t i = 0; i < powers.size(); ++i) {
    const bool above = (i == 0 || powers[i].power >= powers[i - 1].power) &&
                       (i + 1 == powers.size() || powers[i].power > powers[i + 1].power);
    if (above && powers[i].power > chance) peaks.push_back(powers[i]);
  }
  std::sort(peaks.begin(), peaks.end(),
            [](const Peak& a, const Peak& b) { return a.power > b.power; });
  peaks.resize(std::min(peaks.size(), kMostPeaks));
  return peaks;
}

}  // namespace

Line StrongestLine(const Fit& fit, const Candidate& candidate) {
  const auto runs = RowsOf(fit, candidate.cause->line_in(candidate.object));
  std::vector<Candidate> scored{candidate};
  Line line;
  if (!runs.empty()) {
    const Rows all = Together(runs);
    line.step = kOfAWave / all.span();
    line.among = std::max(1.0, (kHighest - kLowest) * all.span());
    std::vector<Peak> best;
    for (std::size_t i = 0; i < std::min(kMostRuns, runs.size()); ++i) {
      const Rows& run = runs[i];
      const double step = kOfAWave / run.span();
      for (const Peak& peak : PeaksOf(PowersOf(run, kLowest, kHighest, step))) {
        const auto near = PowersOf(all, peak.frequency - step, peak.frequency + step, line.step);
        best.push_back(
            *std::max_element(near.begin(), near.end(),
                              [](const Peak& a, const Peak& b) { return a.power < b.power; }));
      }
    }
    std::sort(best.begin(), best.end(),
              [](const Peak& a, const Peak& b) { return a.power > b.power; });
    best.resize(std::min(best.size(), kMostScored));
    for (const Peak& peak : best) {
      scored.push_back(candidate);
      scored.back().shape[0] = peak.frequency;
    }
  }
  const auto scores = ScoreAll(fit, scored);
  line.score = *std::max_element(scores.begin(), scores.end(), [](const Score& a, const Score& b) {
    return a.log_evidence < b.log_evidence;
  });
  return line;
}

}  // namespace abbe::diagnosis
