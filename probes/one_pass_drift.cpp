#include "probes/one_pass_drift.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "probes/head_layout.h"
#include "probes/sweep_uncertainty.h"
#include "settings/unit.h"
#include "standards/chi_squared.h"

namespace abbe::probes {
namespace {

constexpr double kOnePassSignificance = 1.0 - 0.01 / kProbes;

enum class Form : unsigned char { kRough, kBetween, kSmooth };

double Correlation(Form form, double lag) {
  const double x = std::sqrt(3.0) * lag;
  switch (form) {
    case Form::kRough:
      return std::exp(-lag);
    case Form::kBetween:
      return (1.0 + x) * std::exp(-x);
    case Form::kSmooth:
      break;
  }
  return std::exp(-0.5 * lag * lag);
}

Eigen::MatrixXd Correlations(Form form, double fades, const Eigen::VectorXd& time) {
  Eigen::MatrixXd all(time.size(), time.size());
  for (Eigen::Index i = 0; i < time.size(); ++i) {
    for (Eigen::Index j = 0; j < time.size(); ++j) {
      all(i, j) = Correlation(form, std::abs(time[i] - time[j]) / fades);
    }
  }
  return all;
}

// The covariance of forward - backward from that of the groups.
Eigen::MatrixXd OfDifferences(const Eigen::MatrixXd& V) {
  const Eigen::Index stations = V.rows() / 2;
  Eigen::MatrixXd differences(stations, stations);
  for (Eigen::Index i = 0; i < stations; ++i) {
    for (Eigen::Index j = 0; j < stations; ++j) {
      const auto each = V.block<2, 2>(2 * i, 2 * j);
      differences(i, j) = each(0, 0) - each(0, 1) - each(1, 0) + each(1, 1);
    }
  }
  return differences;
}

struct Fit {
  double chi2 = 0.0, log_likelihood = 0.0;
};

// The differences about a constant that is free.
Fit FitOf(const Eigen::VectorXd& differences, const Eigen::MatrixXd& V) {
  const Eigen::LLT<Eigen::MatrixXd> factor(V);
  const auto L = factor.matrixL();
  const Eigen::VectorXd y = L.solve(differences);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(differences.size());
  const Eigen::VectorXd constant = L.solve(ones);
  const double weight = constant.squaredNorm();
  Fit fit;
  fit.chi2 = y.squaredNorm() - std::pow(constant.dot(y), 2) / weight;
  fit.log_likelihood =
      -0.5 * (fit.chi2 + std::log(weight)) - factor.matrixLLT().diagonal().array().log().sum();
  return fit;
}

// From four times the pass to twice the time between two dwells.
std::vector<double> DriftTimes(const Eigen::VectorXd& time) {
  const double whole = time.maxCoeff() - time.minCoeff();
  const double between = whole / static_cast<double>(time.size() - 1);
  std::vector<double> times;
  for (double fades = 4.0 * whole; fades > 2.0 * between; fades /= 2.0) times.push_back(fades);
  return times;
}

// The covariance of the drift, averaged over its form, size and time.
Eigen::MatrixXd AveragedDrift(const Eigen::VectorXd& time, const Eigen::VectorXd& differences,
                              const Eigen::MatrixXd& noise) {
  struct Candidate {
    Form form;
    double fades, log_weight, variance;
  };
  const double variance = differences.squaredNorm() / static_cast<double>(differences.size());
  std::vector<Candidate> candidates;
  for (const Form form : {Form::kRough, Form::kBetween, Form::kSmooth}) {
    for (const double fades : DriftTimes(time)) {
      const Eigen::MatrixXd V = OfDifferences(Correlations(form, fades, time));
      for (double size = 1.0 / 16.0; size <= 32.0; size *= 2.0) {
        const double of = size * size * variance;
        const double prior = std::log(size / (1.0 + size * size));
        const Eigen::MatrixXd sum = noise + of * V;
        candidates.push_back({form, fades, prior + FitOf(differences, sum).log_likelihood, of});
      }
    }
  }
  const double most = std::ranges::max(candidates, {}, &Candidate::log_weight).log_weight;
  constexpr double kNothing = 1e-6;
  double weights = 0.0;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(time.size(), time.size());
  for (const Candidate& each : candidates) {
    const double weight = std::exp(each.log_weight - most);
    weights += weight;
    if (weight < kNothing) continue;
    sum += weight * each.variance * Correlations(each.form, each.fades, time);
  }
  return sum / weights;
}

}  // namespace

std::optional<OnePassDrift> DriftOfOnePass(const Eigen::VectorXd& time, const Eigen::VectorXd& gap,
                                           const Eigen::MatrixXd& noise) {
  const Eigen::Index stations = gap.size() / 2;
  const auto pairs = gap.reshaped(2, stations);
  const Eigen::VectorXd differences = (pairs.row(0) - pairs.row(1)).transpose();
  const Eigen::MatrixXd V = OfDifferences(noise);
  const double chi2 = FitOf(differences, V).chi2;
  const auto freedom = static_cast<double>(stations - 1);
  if (chi2 < standards::ChiSquaredQuantile(kOnePassSignificance, freedom)) return std::nullopt;
  OnePassDrift drift{AveragedDrift(time, differences, V), std::sqrt(chi2 / freedom), 0};
  (differences.array() - differences.mean()).abs().maxCoeff(&drift.station);
  return drift;
}

void CountUncheckedNoise(char axis, StationMeans& means) {
  Eigen::VectorXd time(means.groups());
  const auto directions = std::ssize(means.directions);
  for (const Dwell& dwell : means.dwells) {
    const Eigen::Index k = dwell.direction == means.directions.front() ? 0 : 1;
    time[static_cast<Eigen::Index>(dwell.station) * directions + k] = dwell.time;
  }
  std::string text;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    Eigen::MatrixXd& covariance = means.covariance[probe];
    std::optional<OnePassDrift> drift;
    if (directions == 2) {
      const auto row = static_cast<Eigen::Index>(probe);
      drift = DriftOfOnePass(time, means.gap.row(row).transpose(), covariance);
    }
    covariance *= std::pow(UncheckedTimes(kKnownTo), 2);
    if (!drift) continue;
    covariance += drift->covariance;
    text += fmt::format("{}probe_{:c} by {:.1f} times its noise, most at {:c} = {:.6g} mm",
                        text.empty() ? "" : "; ", 'a' + probe, drift->times, axis,
                        means.stations[drift->station] / settings::kMillimetre);
  }
  if (text.empty()) return;
  means.notes.push_back(fmt::format(
      "one pass: forward and backward differ beyond [noise] ({}): a drift of the probes, or a "
      "reversal that changes along the axis; one pass cannot tell which, so u contains a drift of "
      "that size; let the probes warm up and measure a second pass",
      text));
}

}  // namespace abbe::probes
