#include "probes/dwell_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "estimation/markov_noise.h"

namespace abbe::probes {
namespace {

constexpr double kJump = 1e-6;  // m: what a jump is expected to be like
constexpr double kJumpOdds = 1e3;

estimation::MarkovNoiseFit FitColumns(std::span<const double> times, std::span<const int> groups,
                                      const Eigen::MatrixXd& columns, const Eigen::VectorXd& white,
                                      const ProbeNoise& noise, int group_count) {
  return estimation::FitGroupsUnderDrift(times, groups, columns,
                                         std::span(white.data(), white.size()), noise.drift,
                                         noise.drift_time, group_count);
}

// One from dwell `first` on.
Eigen::VectorXd After(Eigen::Index dwells, Eigen::Index first) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(dwells);
  column.tail(dwells - first).setOnes();
  return column;
}

double LogOdds(double sum, double precision) {
  const double known = kJump * kJump * precision;
  return 0.5 * (sum * sum / (precision + 1.0 / (kJump * kJump)) - std::log1p(known));
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
}

double DwellFit::dof() const {
  double dof = kProbes * static_cast<double>(values_.rows() - group_count_);
  for (const auto& jump : jumps_) dof -= jump ? (jump->free ? 2.0 : 1.0) : 0.0;
  return dof;
}

DwellFit::OfProbe DwellFit::Fit(Eigen::Index probe, Eigen::VectorXd white, const ProbeNoise& noise,
                                const std::optional<Jump>& jump) const {
  const Eigen::Index dwells = values_.rows();
  Eigen::MatrixXd columns(dwells, jump ? 2 : 1);
  columns.col(0) = values_.col(probe);
  if (jump) {
    columns.col(1) = After(dwells, jump->first);
    if (jump->free) white[*jump->free] += jump->size * jump->size;
  }
  const auto fit = FitColumns(times_, groups_, columns, white, noise, group_count_);
  OfProbe found{
      fit.values.col(0), fit.covariance, {fit.chi_square[0], fit.log_restricted_likelihood[0]}};
  if (!jump) return found;
  const double precision = fit.chi_square[1];
  const double sum = columns.col(1).dot(fit.residuals.col(0).cwiseQuotient(white));
  found.size = sum / precision;
  found.u = 1.0 / std::sqrt(precision);
  const Eigen::VectorXd moved = fit.values.col(1);
  found.gap -= found.size * moved;
  found.covariance += moved * moved.transpose() / precision;
  found.sums.chi2 -= sum * found.size;
  found.sums.log_likelihood += LogOdds(sum, precision);
  return found;
}

DwellFit::Sums DwellFit::Run(const Eigen::MatrixXd& white, const ProbeNoise& noise,
                             StationMeans& means) const {
  Sums sums;
  means.gap.resize(kProbes, group_count_);
  means.jumps.clear();
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const auto row = static_cast<Eigen::Index>(probe);
    const auto& jump = jumps_[probe];
    const OfProbe fit = Fit(row, white.col(row), noise, jump);
    means.gap.row(row) = fit.gap.transpose();
    means.covariance[probe] = fit.covariance;
    sums.chi2 += fit.sums.chi2;
    sums.log_likelihood += fit.sums.log_likelihood;
    if (jump)
      means.jumps.push_back({probe, static_cast<std::size_t>(jump->first), fit.size, fit.u});
  }
  return sums;
}

ProbableNoise DwellFit::NoiseOf(Eigen::Index probe, const Eigen::VectorXd& white,
                                const ProbeNoise& noise, const std::optional<Jump>& jump) const {
  return MostProbableNoise([&](const NoiseFactors& logs) {
    return Fit(probe, std::exp(2.0 * logs[0]) * white, Times(noise, logs), jump)
        .sums.log_likelihood;
  });
}

DwellFit::Likeliest DwellFit::LikeliestJump(Eigen::Index probe, const Eigen::VectorXd& white,
                                            const ProbeNoise& noise) const {
  constexpr Eigen::Index kAtOnce = 1024;
  const Eigen::Index dwells = values_.rows();
  const auto fit = FitColumns(times_, groups_, values_.col(probe), white, noise, group_count_);
  const Eigen::VectorXd weighed = fit.residuals.col(0).cwiseQuotient(white);
  Likeliest likeliest{{1, std::nullopt, 0.0}, -std::numeric_limits<double>::infinity()};
  for (Eigen::Index first = 1; first < dwells; first += kAtOnce) {
    const Eigen::Index count = std::min(kAtOnce, dwells - first);
    Eigen::MatrixXd columns(dwells, count);
    for (Eigen::Index i = 0; i < count; ++i) columns.col(i) = After(dwells, first + i);
    const auto of_jumps = FitColumns(times_, groups_, columns, white, noise, group_count_);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double sum = weighed.tail(dwells - first - i).sum();
      const double precision = of_jumps.chi_square[i];
      const double odds = LogOdds(sum, precision);
      if (odds > likeliest.log_odds) {
        likeliest = {{first + i, std::nullopt, sum / precision}, odds};
      }
    }
  }
  return likeliest;
}

bool DwellFit::AtTurn(const Jump& jump) const {
  const Eigen::Index before = jump.free == jump.first - 1 ? jump.first - 2 : jump.first - 1;
  const Eigen::Index after = jump.free == jump.first ? jump.first + 1 : jump.first;
  return before < 0 || after >= std::ssize(halves_) || halves_[before] != halves_[after];
}

bool DwellFit::FindJumps(const Eigen::MatrixXd& white, const ProbeNoise& noise,
                         const NoiseFactors& suiting) {
  const double enough = std::log(kJumpOdds * kProbes * static_cast<double>(values_.rows() - 1));
  bool found = false;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const auto row = static_cast<Eigen::Index>(probe);
    const Eigen::VectorXd of_probe = white.col(row);
    const Likeliest likeliest =
        LikeliestJump(row, std::exp(2.0 * suiting[0]) * of_probe, Times(noise, suiting));
    if (likeliest.log_odds < enough) continue;
    const Jump& jump = likeliest.jump;
    const std::array<Jump, 3> jumps{jump, Jump{jump.first, jump.first - 1, jump.size},
                                    Jump{jump.first, jump.first, jump.size}};
    const Jump best = *std::ranges::max_element(jumps, {}, [&](const Jump& each) {
      return Fit(row, of_probe, noise, each).sums.log_likelihood;
    });
    if (AtTurn(best)) continue;
    const double without = NoiseOf(row, of_probe, noise, std::nullopt).log_probability;
    if (NoiseOf(row, of_probe, noise, best).log_probability - without < enough) continue;
    jumps_[probe] = best;
    found = true;
  }
  return found;
}

void DwellFit::TakeJumpsOut(StationMeans& means) const {
  for (const ZeroJump& jump : means.jumps) {
    for (std::size_t i = jump.dwell; i < means.dwells.size(); ++i) {
      means.dwells[i].gap[jump.probe] -= jump.size;
    }
    const auto row = static_cast<Eigen::Index>(jump.probe);
    const auto& free = jumps_[jump.probe]->free;
    if (free) means.dwells[*free].gap[jump.probe] = means.gap(row, groups_[*free]);
  }
}

}  // namespace abbe::probes
