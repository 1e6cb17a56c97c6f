#include "probes/dwell_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "estimation/markov_noise.h"

namespace abbe::probes {
namespace {

constexpr double kMove = 1e-6;        // m: what a move is expected to be like
constexpr double kTimeKnownTo = 0.7;  // logarithm
constexpr double kMoveOdds = 1e3;
constexpr Eigen::Index kWildOneIn = 20;

estimation::MarkovNoiseFit FitColumns(std::span<const double> times, std::span<const int> groups,
                                      const Eigen::MatrixXd& columns, const Eigen::VectorXd& white,
                                      const ProbeNoise& noise, int group_count) {
  return estimation::FitGroupsUnderDrift(times, groups, columns,
                                         std::span(white.data(), white.size()), noise.drift,
                                         noise.drift_time, group_count);
}

// C' V^-1 y from the residuals V y of the fit.
Eigen::MatrixXd Weighed(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& residuals,
                        const Eigen::VectorXd& white) {
  const Eigen::MatrixXd weighed = white.cwiseInverse().asDiagonal() * residuals;
  return columns.transpose() * weighed;
}

double LogOdds(const Eigen::VectorXd& sum, const Eigen::MatrixXd& precision) {
  Eigen::VectorXd prior(sum.size());  // standard deviations
  for (Eigen::Index i = 0; i < sum.size(); ++i) prior[i] = i == 0 ? kMove : kTimeKnownTo;
  const Eigen::MatrixXd known = prior.asDiagonal() * precision * prior.asDiagonal();
  const Eigen::MatrixXd all = Eigen::MatrixXd::Identity(sum.size(), sum.size()) + known;
  const Eigen::LLT<Eigen::MatrixXd> factor(all);
  const Eigen::VectorXd scaled = factor.matrixL().solve(prior.cwiseProduct(sum));
  return 0.5 * scaled.squaredNorm() - factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

ProbeNoise Times(ProbeNoise noise, const NoiseFactors& logs) {
  noise.drift *= std::exp(logs[1]);
  noise.drift_time *= std::exp(logs[2]);
  return noise;
}

ProbableNoise MostProbableNoise(
    const std::function<double(const NoiseFactors& logs)>& log_likelihood) {
  constexpr double kUnknown = 0.7, kFirstStep = 0.7, kLastStep = 0.05;
  const auto probability = [&](const NoiseFactors& logs) {
    double log = log_likelihood(logs);
    for (const double each : logs) log -= 0.5 * std::pow(each / kUnknown, 2);
    return log;
  };
  NoiseFactors best{};
  double most = probability(best);
  for (double step = kFirstStep; step > kLastStep;) {
    bool moved = false;
    for (double& each : best) {
      for (const double way : {step, -step}) {
        each += way;
        const double here = probability(best);
        if (here > most) {
          most = here;
          moved = true;
          break;
        }
        each -= way;
      }
    }
    if (!moved) step /= 2.0;
  }
  return {best, most};
}

DwellFit::DwellFit(const StationMeans& means) {
  const auto directions = static_cast<int>(means.directions.size());
  values_.resize(std::ssize(means.dwells), kProbes);
  for (Eigen::Index i = 0; i < values_.rows(); ++i) {
    const Dwell& dwell = means.dwells[i];
    const int k = dwell.direction == means.directions.front() ? 0 : 1;
    groups_.push_back(static_cast<int>(dwell.station) * directions + k);
    halves_.emplace_back(dwell.pass, dwell.direction);
    times_.push_back(dwell.time);
    for (std::size_t probe = 0; probe < kProbes; ++probe) values_(i, probe) = dwell.gap[probe];
  }
  group_count_ = static_cast<int>(means.stations.size()) * directions;
  wild_ = Eigen::MatrixXd::Zero(values_.rows(), kProbes);
}

double DwellFit::dof() const {
  double dof = kProbes * static_cast<double>(values_.rows() - group_count_);
  for (const auto& move : moves_) {
    if (move) dof -= move->free || move->settles > 0.0 ? 2.0 : 1.0;
  }
  return dof;
}

Eigen::MatrixXd DwellFit::ColumnsOf(const Move& move) const {
  const Eigen::Index dwells = values_.rows();
  if (move.alone) return Eigen::VectorXd::Unit(dwells, move.first);
  if (move.settles == 0.0) {
    Eigen::MatrixXd after = Eigen::MatrixXd::Zero(dwells, 1);
    after.bottomRows(dwells - move.first).setOnes();
    return after;
  }
  Eigen::MatrixXd columns(dwells, 2);
  for (Eigen::Index i = 0; i < dwells; ++i) {
    const double since = (times_[i] - times_.front()) / move.settles;
    columns(i, 0) = -std::expm1(-since);
    columns(i, 1) = -move.size * since * std::exp(-since);
  }
  return columns;
}

Eigen::VectorXd DwellFit::WithWild(Eigen::Index probe, Eigen::VectorXd white) const {
  return white += wild_.col(probe);
}

DwellFit::OfProbe DwellFit::Fit(Eigen::Index probe, Eigen::VectorXd white, const ProbeNoise& noise,
                                const std::optional<Move>& move) const {
  white = WithWild(probe, std::move(white));
  Eigen::MatrixXd columns = values_.col(probe);
  if (move) {
    const Eigen::MatrixXd of_move = ColumnsOf(*move);
    columns.conservativeResize(Eigen::NoChange, 1 + of_move.cols());
    columns.rightCols(of_move.cols()) = of_move;
    if (move->free) white[*move->free] += move->size * move->size;
  }
  const auto fit = FitColumns(times_, groups_, columns, white, noise, group_count_);
  OfProbe found{
      fit.values.col(0), fit.covariance, {fit.chi_square[0], fit.log_restricted_likelihood[0]}};
  if (!move) return found;
  const Eigen::MatrixXd of_move = columns.rightCols(columns.cols() - 1);
  const Eigen::MatrixXd weighed = Weighed(of_move, fit.residuals, white);
  const Eigen::VectorXd sum = weighed.col(0);
  const Eigen::MatrixXd precision = weighed.rightCols(of_move.cols());
  const Eigen::MatrixXd covariance = precision.inverse();
  found.unknowns = covariance * sum;
  found.u = covariance.diagonal().cwiseSqrt();
  const Eigen::MatrixXd moved = fit.values.rightCols(of_move.cols());
  found.gap -= moved * found.unknowns;
  found.covariance += moved * covariance * moved.transpose();
  found.sums.chi2 -= sum.dot(found.unknowns);
  found.sums.log_likelihood += LogOdds(sum, precision);
  return found;
}

DwellFit::Sums DwellFit::Run(const Eigen::MatrixXd& white, const ProbeNoise& noise,
                             StationMeans& means) const {
  Sums sums;
  means.gap.resize(kProbes, group_count_);
  means.moves.clear();
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const auto row = static_cast<Eigen::Index>(probe);
    const auto& move = moves_[probe];
    const OfProbe fit = Fit(row, white.col(row), noise, move);
    means.gap.row(row) = fit.gap.transpose();
    means.covariance[probe] = fit.covariance;
    sums.chi2 += fit.sums.chi2;
    sums.log_likelihood += fit.sums.log_likelihood;
    if (!move) continue;
    means.moves.push_back(
        {probe, static_cast<std::size_t>(move->first), fit.unknowns[0], fit.u[0], move->settles});
  }
  return sums;
}

ProbableNoise DwellFit::NoiseOf(Eigen::Index probe, const Eigen::VectorXd& white,
                                const ProbeNoise& noise, const std::optional<Move>& move) const {
  return MostProbableNoise([&](const NoiseFactors& logs) {
    return Fit(probe, std::exp(2.0 * logs[0]) * white, Times(noise, logs), move)
        .sums.log_likelihood;
  });
}

DwellFit::Likeliest DwellFit::LikeliestOf(const std::vector<Move>& moves, Eigen::Index probe,
                                          const Eigen::VectorXd& noise_of_dwells,
                                          const ProbeNoise& noise) const {
  constexpr Eigen::Index kAtOnce = 1024;
  const Eigen::VectorXd white = WithWild(probe, noise_of_dwells);
  const auto fit = FitColumns(times_, groups_, values_.col(probe), white, noise, group_count_);
  Likeliest likeliest{moves.front(), -std::numeric_limits<double>::infinity()};
  for (Eigen::Index from = 0; from < std::ssize(moves); from += kAtOnce) {
    const Eigen::Index count = std::min(kAtOnce, std::ssize(moves) - from);
    Eigen::MatrixXd columns(values_.rows(), count);
    for (Eigen::Index i = 0; i < count; ++i) columns.col(i) = ColumnsOf(moves[from + i]).col(0);
    const auto of_moves = FitColumns(times_, groups_, columns, white, noise, group_count_);
    const Eigen::VectorXd sums = Weighed(columns, fit.residuals, white);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double precision = of_moves.chi_square[i];
      const double odds = LogOdds(Eigen::VectorXd::Constant(1, sums[i]),
                                  Eigen::MatrixXd::Constant(1, 1, precision));
      if (odds <= likeliest.log_odds) continue;
      likeliest = {moves[from + i], odds};
      likeliest.move.size = sums[i] / precision;
    }
  }
  return likeliest;
}

// Before each dwell.
std::vector<DwellFit::Move> DwellFit::Jumps() const {
  std::vector<Move> jumps;
  for (Eigen::Index first = 1; first < values_.rows(); ++first) {
    jumps.push_back({first, std::nullopt, 1.0});
  }
  return jumps;
}

// With times from twice the sweep to twice the time between two dwells.
std::vector<DwellFit::Move> DwellFit::WarmingsUp() const {
  std::vector<Move> warmings;
  for (double settles = 2.0 * Whole(); settles > 2.0 * Between(); settles /= 2.0) {
    warmings.push_back({0, std::nullopt, 1.0, settles});
  }
  return warmings;
}

std::vector<DwellFit::Move> DwellFit::Alone() const {
  std::vector<Move> alone;
  for (Eigen::Index i = 0; i < values_.rows(); ++i) {
    if (std::ranges::count(groups_, groups_[i]) > 1) {
      alone.push_back({.first = i, .free = {}, .size = 1.0, .alone = true});
    }
  }
  return alone;
}

double DwellFit::Whole() const { return times_.back() - times_.front(); }
double DwellFit::Between() const { return Whole() / static_cast<double>(values_.rows() - 1); }

bool DwellFit::AtTurn(const Move& jump) const {
  const Eigen::Index before = jump.free == jump.first - 1 ? jump.first - 2 : jump.first - 1;
  const Eigen::Index after = jump.free == jump.first ? jump.first + 1 : jump.first;
  return before < 0 || after >= std::ssize(halves_) || halves_[before] != halves_[after];
}

DwellFit::Move DwellFit::Refined(Move move, Eigen::Index probe, const Eigen::VectorXd& white,
                                 const ProbeNoise& noise) const {
  if (move.settles == 0.0) {
    const std::array<Move, 3> within{move, Move{move.first, move.first - 1, move.size},
                                     Move{move.first, move.first, move.size}};
    return *std::ranges::max_element(within, {}, [&](const Move& each) {
      return Fit(probe, white, noise, each).sums.log_likelihood;
    });
  }
  constexpr int kSteps = 12;
  constexpr double kFarthest = 0.5;  // of a step of log(tau)
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::VectorXd unknowns = Fit(probe, white, noise, move).unknowns;
    move.size = unknowns[0];
    move.settles *= std::exp(std::clamp(unknowns[1], -kFarthest, kFarthest));
    move.settles = std::clamp(move.settles, Between(), 4.0 * Whole());
  }
  return move;
}

// The noise that suits all probes hides a warming up of several of them, but no jump.
std::vector<DwellFit::Move> DwellFit::Candidates(Eigen::Index probe, const Eigen::VectorXd& white,
                                                 const ProbeNoise& noise,
                                                 const NoiseFactors& suiting, double enough) const {
  const Eigen::VectorXd suited = std::exp(2.0 * suiting[0]) * white;
  std::vector<Move> candidates;
  const Likeliest jump = LikeliestOf(Jumps(), probe, suited, Times(noise, suiting));
  if (jump.log_odds > enough) {
    const Move refined = Refined(jump.move, probe, white, noise);
    if (!AtTurn(refined)) candidates.push_back(refined);
  }
  const Likeliest warming = LikeliestOf(WarmingsUp(), probe, suited, Times(noise, suiting));
  if (warming.log_odds > 0.0) candidates.push_back(Refined(warming.move, probe, white, noise));
  return candidates;
}

bool DwellFit::FindMoves(const Eigen::MatrixXd& white, const ProbeNoise& noise,
                         const NoiseFactors& suiting) {
  const double enough = std::log(kMoveOdds * kProbes * static_cast<double>(values_.rows() - 1));
  bool found = false;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const auto row = static_cast<Eigen::Index>(probe);
    const Eigen::VectorXd of_probe = white.col(row);
    double most = NoiseOf(row, of_probe, noise, std::nullopt).log_probability + enough;
    for (const Move& move : Candidates(row, of_probe, noise, suiting, enough)) {
      const double probability = NoiseOf(row, of_probe, noise, move).log_probability;
      if (!(probability > most)) continue;  // nor what is not finite
      most = probability;
      moves_[probe] = move;
      found = true;
    }
  }
  return found;
}

bool DwellFit::FindWild(const Eigen::MatrixXd& white, const ProbeNoise& noise) {
  const std::vector<Move> alone = Alone();
  if (alone.empty()) return false;
  const double enough = std::log(kMoveOdds * kProbes * static_cast<double>(values_.rows()));
  const auto first = wild_dwells_.size();
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const auto row = static_cast<Eigen::Index>(probe);
    const Eigen::VectorXd of_probe = white.col(row);
    ProbableNoise now = NoiseOf(row, of_probe, noise, std::nullopt);
    for (Eigen::Index count = 0; count < values_.rows() / kWildOneIn; ++count) {
      const Move worst =
          LikeliestOf(alone, row, std::exp(2.0 * now.logs[0]) * of_probe, Times(noise, now.logs))
              .move;
      std::vector<Eigen::Index> of_group;
      for (Eigen::Index i = 0; i < values_.rows(); ++i) {
        if (groups_[i] == groups_[worst.first]) of_group.push_back(i);
      }
      const bool or_other = of_group.size() == 2;
      if (!or_other) of_group = {worst.first};
      const Eigen::VectorXd before = wild_.col(row);
      for (const Eigen::Index i : of_group) wild_(i, row) += worst.size * worst.size;
      const ProbableNoise then = NoiseOf(row, of_probe, noise, std::nullopt);
      if (!(then.log_probability > now.log_probability + enough)) {
        wild_.col(row) = before;
        break;
      }
      now = then;
      wild_dwells_.push_back({probe, static_cast<std::size_t>(worst.first), worst.size, or_other});
    }
  }
  return wild_dwells_.size() > first;
}

void DwellFit::TakeMovesOut(StationMeans& means) const {
  for (const ZeroMove& move : means.moves) {
    const auto& found = moves_[move.probe];
    const Eigen::MatrixXd columns = ColumnsOf(*found);
    for (std::size_t i = 0; i < means.dwells.size(); ++i) {
      means.dwells[i].gap[move.probe] -= move.size * columns(static_cast<Eigen::Index>(i), 0);
    }
    const auto row = static_cast<Eigen::Index>(move.probe);
    if (found->free)
      means.dwells[*found->free].gap[move.probe] = means.gap(row, groups_[*found->free]);
  }
  means.wild = wild_dwells_;
  for (Eigen::Index probe = 0; probe < wild_.cols(); ++probe) {
    for (Eigen::Index i = 0; i < wild_.rows(); ++i) {
      if (wild_(i, probe) > 0.0) means.dwells[i].gap[probe] = means.gap(probe, groups_[i]);
    }
  }
}

}  // namespace abbe::probes
