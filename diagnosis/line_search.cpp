#include "diagnosis/line_search.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "diagnosis/evidence.h"
#include "diagnosis/wave_spectrum.h"

namespace abbe::diagnosis {
namespace {

using Eigen::ArrayXcd;
using Eigen::ArrayXd;
using Eigen::Index;

constexpr double kMostWaves = 4096.0;    // in a piece
constexpr std::size_t kMostPieces = 6;   // looked through by themselves, the strongest
constexpr std::size_t kMostPeaks = 64;   // looked at in all runs
constexpr std::size_t kMostScored = 16;  // to find the strongest
constexpr double kFineStep = 0.2;        // of a wave over all runs
constexpr double kStands = 1e-3;         // of the longest motion
constexpr int kBins = 8;                 // of a piece, in which phases hardly turn about a peak

// Rows of a run; `readings`, of which each is the mean.
struct RunOfWave {
  const simulation::Trace* trace;
  WaveRows rows;
  ArrayXd readings;
};

struct Peak {
  double waves, power;
};

double HighestOf(const simulation::Wave& wave) {
  return std::max(wave.WavesOf(wave.least), wave.WavesOf(wave.most));
}

double LowestOf(const simulation::Wave& wave) {
  return std::min(wave.WavesOf(wave.least), wave.WavesOf(wave.most));
}

// Those that do not stand at one place, where a wave is a constant.
std::vector<RunOfWave> RunsOf(const Fit& fit, const Candidate& candidate) {
  const simulation::Wave& wave = *candidate.cause->wave;
  std::vector<RunOfWave> runs;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const simulation::Trace& trace = fit.TraceOf(run);
    const Eigen::VectorXd at = wave.over(trace, candidate.object);
    const auto of_run = fit.ScoresOf(run, wave.stage(candidate.object));
    if (at.size() < 3 || of_run.scores.size() != at.size()) continue;
    if (!(of_run.weights.maxCoeff() > 0.0)) continue;
    const bool means = trace.samples.size() == at.size();
    runs.push_back(
        {&trace,
         {at.array(), of_run.scores.transpose().array(), of_run.weights.transpose().array()},
         means ? ArrayXd(trace.samples.array().max(1.0)) : ArrayXd::Ones(at.size())});
  }
  double longest = 0.0;
  for (const RunOfWave& run : runs) longest = std::max(longest, run.rows.length());
  std::erase_if(runs, [&](const RunOfWave& run) { return run.rows.length() <= kStands * longest; });
  return runs;
}

struct Extent {
  double first, last;

  double length() const { return last - first; }
};

Extent ExtentOf(const std::vector<RunOfWave>& runs) {
  Extent extent{runs.front().rows.at.minCoeff(), runs.front().rows.at.maxCoeff()};
  for (const RunOfWave& run : runs) {
    extent.first = std::min(extent.first, run.rows.at.minCoeff());
    extent.last = std::max(extent.last, run.rows.at.maxCoeff());
  }
  return extent;
}

// All rows, in pieces of a length. Of a mean over a stay most frequencies leave one part in so many
// readings: those count most in which most is left.
std::vector<WaveRows> PiecesOf(const std::vector<RunOfWave>& runs, double first, double length) {
  struct Rows {
    std::vector<double> at, scores, weights;
    double kept = 0.0;
  };
  std::map<long, Rows> pieces;
  for (const RunOfWave& run : runs) {
    for (Index row = 0; row < run.rows.at.size(); ++row) {
      Rows& piece = pieces[std::lround(std::floor((run.rows.at[row] - first) / length))];
      piece.at.push_back(run.rows.at[row]);
      piece.scores.push_back(run.rows.scores[row]);
      piece.weights.push_back(run.rows.weights[row]);
      piece.kept += run.rows.weights[row] / run.readings[row];
    }
  }
  std::vector<const Rows*> strongest;
  for (const auto& [number, rows] : pieces) {
    if (rows.kept > 0.0) strongest.push_back(&rows);
  }
  std::ranges::sort(strongest, std::greater(), &Rows::kept);
  strongest.resize(std::min(strongest.size(), kMostPieces));
  const auto array = [](const std::vector<double>& values) -> ArrayXd {
    return Eigen::Map<const ArrayXd>(values.data(), values.size());
  };
  std::vector<WaveRows> found;
  found.reserve(strongest.size());
  for (const Rows* rows : strongest) {
    found.push_back({array(rows->at), array(rows->scores), array(rows->weights)});
  }
  return found;
}

// What so many powers of two degrees of freedom each hardly exceed by chance: Laurent and Massart,
// Ann. Statist. 28 (2000).
double ByChance(std::size_t pieces, Index among) {
  const double freedom = 2.0 * pieces;
  const double rare = std::log(among);
  return freedom + 2.0 * std::sqrt(freedom * rare) + 2.0 * rare;
}

// Sums about one number of waves, in places so near that the phase is the same for all numbers near
// it.
struct Demodulated {
  std::vector<double> at;
  std::vector<std::complex<double>> sums;
  double information = 0.0;
};

Demodulated About(const std::vector<RunOfWave>& runs, Candidate candidate, double waves,
                  double length) {
  const simulation::Wave& wave = *candidate.cause->wave;
  const Index stage = wave.stage(candidate.object);
  // Not that of an order, which is whole.
  const double turn = 2.0 * std::numbers::pi * waves;
  candidate.shape[0] = wave.ShapeOf(waves);
  Demodulated found;
  for (const RunOfWave& run : runs) {
    ArrayXd kept = ArrayXd::Ones(run.rows.at.size());
    const ArrayXd cosine = (turn * run.rows.at).cos(), sine = (turn * run.rows.at).sin();
    if (wave.shape == simulation::Wave::Shape::kFrequency) {
      const auto columns = candidate.cause->columns(*run.trace, candidate.object, candidate.shape);
      if (columns.size() != 2) continue;
      kept = columns[0].stages().at(stage).transpose().array() * sine +
             columns[1].stages().at(stage).transpose().array() * cosine;
    }
    long bin = -1;
    for (Index row = 0; row < run.rows.at.size(); ++row) {
      const double at = run.rows.at[row];
      const long own = std::lround(std::floor(kBins * at / length));
      if (found.at.empty() || own != bin) {
        bin = own;
        found.at.push_back((own + 0.5) * length / kBins);
        found.sums.emplace_back(0.0, 0.0);
      }
      found.sums.back() += run.rows.scores[row] * kept[row] * std::complex(cosine[row], -sine[row]);
      found.information += 0.5 * run.rows.weights[row] * kept[row] * kept[row];
    }
  }
  return found;
}

// The top of the parabola through three of equal distance, from the one in the middle.
double Top(double before, double here, double after) {
  const double bend = before - 2.0 * here + after;
  return bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
}

// In all runs together, near one number of waves.
std::vector<Peak> FinePeaks(const Demodulated& about, double waves, double reach, double step) {
  const Index bins = about.at.size();
  const ArrayXd at = Eigen::Map<const ArrayXd>(about.at.data(), bins);
  const double turn = -2.0 * std::numbers::pi;
  const auto phasor = [&](double off) -> ArrayXcd {
    return (std::complex(0.0, turn * off) * at).exp();
  };
  ArrayXcd now = Eigen::Map<const ArrayXcd>(about.sums.data(), bins) * phasor(-reach);
  const ArrayXcd on = phasor(step);
  const auto count = static_cast<Index>(2.0 * reach / step) + 1;
  ArrayXd power(count);
  for (Index i = 0; i < count; ++i, now *= on) {
    power[i] = std::norm(now.sum()) / std::max(about.information, 1e-300);
  }
  std::vector<Peak> peaks;
  for (const Index i : PeaksOf(power, 0.0)) {
    const double off = i > 0 && i + 1 < count ? Top(power[i - 1], power[i], power[i + 1]) : 0.0;
    peaks.push_back({waves - reach + (i + off) * step, power[i]});
  }
  return peaks;
}

}  // namespace

std::vector<Candidate> LinesThatStandOut(const Fit& fit, const Candidate& candidate,
                                         std::size_t at_most) {
  const simulation::Wave& wave = *candidate.cause->wave;
  const auto runs = RunsOf(fit, candidate);
  if (runs.empty()) return {};
  const Extent extent = ExtentOf(runs);
  if (!(extent.length() > 0.0)) return {};
  const double highest = HighestOf(wave), lowest = LowestOf(wave);
  const double length = std::min(extent.length(), kMostWaves / highest);
  const WaveGrid grid(length, highest);
  const std::vector<WaveRows> pieces = PiecesOf(runs, extent.first, length);
  ArrayXd power = ArrayXd::Zero(grid.waves());
  for (const WaveRows& piece : pieces) power += grid.PowerOf(piece);
  power.head(std::min(grid.waves(), static_cast<Index>(lowest / grid.step()))).setZero();
  std::vector<Index> coarse = PeaksOf(power, ByChance(pieces.size(), grid.waves()));
  coarse.resize(std::min(coarse.size(), kMostPeaks));
  std::vector<Peak> peaks;
  for (const Index index : coarse) {
    const double waves = grid.WaveAt(index);
    for (const Peak& peak : FinePeaks(About(runs, candidate, waves, length), waves, grid.step(),
                                      kFineStep / extent.length())) {
      if (peak.waves >= lowest && peak.waves <= highest) peaks.push_back(peak);
    }
  }
  std::ranges::sort(peaks, std::greater(), &Peak::power);
  std::vector<Candidate> found;
  for (const Peak& peak : peaks) {
    if (found.size() >= at_most) break;
    Candidate line = candidate;
    line.shape[0] = wave.ShapeOf(peak.waves);
    const auto same = [&](const Candidate& other) {
      return std::abs(wave.WavesOf(other.shape[0]) - wave.WavesOf(line.shape[0])) <
             kFineStep / extent.length();
    };
    if (std::ranges::none_of(found, same)) found.push_back(std::move(line));
  }
  return found;
}

double ResolvedBy(const Fit& fit, const Candidate& candidate) {
  if (!candidate.cause->wave) return 0.0;
  const auto runs = RunsOf(fit, candidate);
  const double length = runs.empty() ? 0.0 : ExtentOf(runs).length();
  return 1.0 / std::min(std::max(length, 1e-300), kMostWaves / HighestOf(*candidate.cause->wave));
}

Line StrongestLine(const Fit& fit, const Candidate& candidate) {
  constexpr double kAlike = 0.1;  // in log evidence: the slowest of those is the likeliest
  const simulation::Wave& wave = *candidate.cause->wave;
  std::vector<Candidate> tried = LinesThatStandOut(fit, candidate, kMostScored);
  tried.push_back(candidate);
  const auto scores = ScoreAll(fit, tried);
  const auto best = std::ranges::max_element(scores, {}, &Score::log_evidence);
  Line line{*best};
  const auto waves = [&](const Score& score) { return wave.WavesOf(score.candidate.shape[0]); };
  for (const Score& score : scores) {
    if (score.log_evidence > best->log_evidence - kAlike && waves(score) < waves(line.score)) {
      line.score = score;
    }
  }
  const auto runs = RunsOf(fit, candidate);
  const double length = runs.empty() ? 0.0 : ExtentOf(runs).length();
  if (length > 0.0) {
    line.among = std::max(1.0, (HighestOf(wave) - LowestOf(wave)) * length);
    line.step = 1.0 + kFineStep / (length * waves(line.score));
  }
  return line;
}

}  // namespace abbe::diagnosis
