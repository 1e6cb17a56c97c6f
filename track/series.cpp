#include "track/series.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "failure/failure.h"
#include "track/first_order_lag.h"
#include "track/gaussian.h"
#include "track/maximum.h"

namespace abbe::track {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFewestRows = 12;
constexpr double kGross = 50.0;  // times the usual change
constexpr double kHour = 3600.0;
constexpr double kLeastLag = 1.0;    // s
constexpr double kLeastSize = 1e-3;  // of walk and noise, of the usual change
constexpr int kSeriesRounds = 3;

// The median change from row to row, at least the smallest one that is not 0.
double UsualChange(const VectorXd& value) {
  VectorXd change = (value.tail(value.size() - 1) - value.head(value.size() - 1)).cwiseAbs();
  std::sort(change.begin(), change.end());
  const auto first = std::upper_bound(change.begin(), change.end(), 0.0);
  const double least = first == change.end() ? 1.0 : *first;
  return std::max(change[change.size() / 2], least);
}

void RefuseBad(const Series& series) {
  const Index rows = series.value.size();
  if (rows < kFewestRows) {
    throw InputError(fmt::format("{}: {} rows tell no response; it takes at least {}", series.name,
                                 rows, kFewestRows));
  }
  if (!series.value.allFinite() || !series.temperature.allFinite() || !series.time.allFinite()) {
    throw InputError(series.name + ": holds a number that is not finite");
  }
  const double usual = UsualChange(series.value);
  for (Index row = 1; row < rows; ++row) {
    if (series.time[row] < series.time[row - 1]) {
      throw InputError(fmt::format("{}: row {}: its clock jumps back by {:.1f} s", series.name,
                                   row + 1, series.time[row - 1] - series.time[row]));
    }
    const double change = std::abs(series.value[row] - series.value[row - 1]);
    if (change <= kGross * usual) continue;
    throw InputError(fmt::format(
        "{}: row {}: jumps by {:.4g}, {:.0f} times the usual change from row to row; no temperature "
        "does that: look for lost steps or a part that slipped, and leave those rows out",
        series.name, row + 1, change, change / usual));
  }
}

// The state is [z, gain of each sensor].
class SeriesFilter {
 public:
  SeriesFilter(const Series& series, const std::vector<bool>& held_out)
      : series_(series), held_out_(held_out), usual_(UsualChange(series.value)) {
    const double kelvin =
        (series.temperature.rowwise().maxCoeff() - series.temperature.rowwise().minCoeff())
            .maxCoeff();
    const double range = series.value.maxCoeff() - series.value.minCoeff();
    loose_ = 10.0 * std::max(range, usual_);
    loose_gain_ = kelvin > 0.0 ? loose_ / kelvin : 1.0;
  }

  // theta: logarithms of the lags, of the walk and of the noise.
  VectorXd Start() const {
    VectorXd theta(sensors() + 2);
    theta.head(sensors()).setConstant(std::log(0.02 * Duration()));
    theta.tail<2>().setConstant(std::log(usual_));
    return theta;
  }
  VectorXd Low() const {
    VectorXd theta(sensors() + 2);
    theta.head(sensors()).setConstant(std::log(kLeastLag));
    theta.tail<2>().setConstant(std::log(kLeastSize * usual_));
    return theta;
  }
  VectorXd High() const {
    VectorXd theta(sensors() + 2);
    theta.head(sensors()).setConstant(std::log(Duration()));
    theta.tail<2>().setConstant(std::log(loose_));
    return theta;
  }

  double LogLikelihood(const VectorXd& theta) const { return Run(theta, nullptr); }

  SeriesResponse Smooth(const VectorXd& theta) const {
    std::vector<Step> steps;
    Run(theta, &steps);
    SeriesResponse response;
    const Index rows = series_.value.size();
    response.walk = std::exp(theta[sensors()]);
    response.noise = std::exp(theta[sensors() + 1]);
    response.value.resize(rows);
    response.u.resize(rows);
    VectorXd mean = steps.back().mean;
    MatrixXd P = steps.back().covariance;
    for (Index row = rows - 1; row >= 0; --row) {
      if (row < rows - 1) {
        const Step& now = steps[row];
        const Step& next = steps[row + 1];
        const MatrixXd gain = next.predicted.ldlt().solve(next.move * now.covariance).transpose();
        mean = now.mean + gain * (mean - next.expected);
        P = now.covariance + gain * (P - next.predicted) * gain.transpose();
      }
      response.value[row] = series_.value[0] + mean[0];
      response.u[row] = std::hypot(std::sqrt(std::max(P(0, 0), 0.0)), response.noise);
    }
    for (Index s = 0; s < sensors(); ++s) {
      const Step& last = steps.back();
      response.sensors.push_back({.sensor = series_.sensors[s],
                                  .gain = last.mean[1 + s],
                                  .u_gain = std::sqrt(last.covariance(1 + s, 1 + s)),
                                  .lag = std::exp(theta[s])});
    }
    return response;
  }

 private:
  struct Step {
    MatrixXd move, predicted, covariance;
    VectorXd expected, mean;
  };

  Index sensors() const { return series_.temperature.rows(); }
  double Duration() const {
    return std::max(series_.time[series_.time.size() - 1] - series_.time[0], 10.0);
  }

  double Run(const VectorXd& theta, std::vector<Step>* steps) const {
    const double walk = std::exp(theta[sensors()]), noise = std::exp(theta[sensors() + 1]);
    const Index n = 1 + sensors();
    VectorXd deviations = VectorXd::Constant(n, loose_gain_);
    deviations[0] = loose_;
    Gaussian state{VectorXd::Zero(n), deviations.asDiagonal()};
    VectorXd lagged = series_.temperature.col(0);
    double log = 0.0;
    for (Index row = 0; row < series_.value.size(); ++row) {
      MatrixXd move = MatrixXd::Identity(n, n);
      if (row > 0) {
        const double seconds = series_.time[row] - series_.time[row - 1];
        for (Index s = 0; s < sensors(); ++s) {
          const double before = lagged[s];
          lagged[s] = LagAfter(before, series_.temperature(s, row - 1), series_.temperature(s, row),
                               seconds, std::exp(theta[s]));
          move(0, 1 + s) = lagged[s] - before;
        }
        state.mean = move * state.mean;
        state.root =
            RootOfSum(move * state.root, VectorXd::Unit(n, 0) * walk * std::sqrt(seconds / kHour));
      }
      Step step;
      if (steps != nullptr) step = {move, state.Covariance(), {}, state.mean, {}};
      if (held_out_.empty() || !held_out_[row]) {
        const double weight = 1.0 / (noise * noise);
        const double off = series_.value[row] - series_.value[0];
        log += Measure({{0}, MatrixXd::Constant(1, 1, weight), VectorXd::Constant(1, weight * off)},
                       state);
        // What Measure leaves out.
        log -= 0.5 * weight * off * off + std::log(noise);
      }
      if (steps == nullptr) continue;
      step.covariance = state.Covariance();
      step.mean = state.mean;
      steps->push_back(std::move(step));
    }
    return log;
  }

  const Series& series_;
  const std::vector<bool>& held_out_;
  double usual_, loose_, loose_gain_;
};

// A maximum of the likelihood, and the principal axes of its curvature there, as long as a standard
// deviation.
struct Peak {
  VectorXd theta;
  double log;
  MatrixXd axes;
};

// By second differences over the way on which the likelihood falls a little.
Peak PeakAbout(const SeriesFilter& filter, const VectorXd& theta) {
  constexpr double kFalls = 0.5;   // of the logarithm
  constexpr double kWidest = 1.5;  // standard deviation, of a logarithm
  const Index n = theta.size();
  const double here = filter.LogLikelihood(theta);
  VectorXd step = VectorXd::Constant(n, 0.2);
  const auto log = [&](Index i, double by_i, Index j, double by_j) {
    VectorXd at = theta;
    at[i] += by_i * step[i];
    at[j] += by_j * step[j];
    return filter.LogLikelihood(at);
  };
  VectorXd slope(n);
  MatrixXd curvature(n, n);  // both by `step`
  for (Index i = 0; i < n; ++i) {
    double above = log(i, 1.0, i, 0.0), below = log(i, -1.0, i, 0.0);
    for (int halving = 0; halving < 8 && 2.0 * here - above - below > 2.0 * kFalls; ++halving) {
      step[i] /= 2.0;
      above = log(i, 1.0, i, 0.0);
      below = log(i, -1.0, i, 0.0);
    }
    slope[i] = 0.5 * (above - below);
    curvature(i, i) = 2.0 * here - above - below;
    for (Index j = 0; j < i; ++j) {
      const double mixed =
          log(i, 1.0, j, 1.0) - log(i, 1.0, j, -1.0) - log(i, -1.0, j, 1.0) + log(i, -1.0, j, -1.0);
      curvature(i, j) = curvature(j, i) = -0.25 * mixed;
    }
  }
  const VectorXd scale = step.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(
      MatrixXd(scale.asDiagonal() * curvature * scale.asDiagonal()));
  const VectorXd lengths =
      eigen.eigenvalues().cwiseMax(1.0 / (kWidest * kWidest)).cwiseSqrt().cwiseInverse();
  Peak peak{theta, here, eigen.eigenvectors() * lengths.asDiagonal()};
  const VectorXd way = peak.axes * (peak.axes.transpose() * scale.cwiseProduct(slope));
  const VectorXd next = (theta + way).cwiseMax(filter.Low()).cwiseMin(filter.High());
  if (const double log_next = filter.LogLikelihood(next); log_next > here) {
    peak.theta = next;
    peak.log = log_next;
  }
  return peak;
}

struct Weighted {
  double weight;
  VectorXd theta;
  SeriesResponse response;
};

// The maximum, and points beside it whose weights have the variance of the likelihood.
std::vector<Weighted> PointsAbout(const SeriesFilter& filter, const VectorXd& theta) {
  constexpr int kNewtonSteps = 3;
  Peak peak{theta, 0.0, {}};
  for (int step = 0; step < kNewtonSteps; ++step) peak = PeakAbout(filter, peak.theta);
  const double far = static_cast<double>(theta.size()) + 1.0;
  std::vector<Weighted> points{{1.0 / far, peak.theta, filter.Smooth(peak.theta)}};
  double sum = points.front().weight;
  for (Index axis = 0; axis < peak.axes.cols(); ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const VectorXd at = (peak.theta + side * std::sqrt(far) * peak.axes.col(axis))
                              .cwiseMax(filter.Low())
                              .cwiseMin(filter.High());
      // 0 for a normal density.
      const double off = filter.LogLikelihood(at) - peak.log + 0.5 * far;
      points.push_back({0.5 / far * std::exp(std::clamp(off, -20.0, 2.0)), at, filter.Smooth(at)});
      sum += points.back().weight;
    }
  }
  for (Weighted& point : points) point.weight /= sum;
  return points;
}

SeriesResponse MeanOf(const SeriesFilter& filter, const std::vector<Weighted>& points) {
  constexpr double kAtBound = 0.05;  // of a logarithm
  SeriesResponse mean = points.front().response;
  // A quantity at each of the points: its mean, and its standard uncertainty in all.
  const auto together = [&](const auto& value, const auto& u) {
    double first = 0.0, squares = 0.0;
    for (const Weighted& point : points) first += point.weight * value(point);
    for (const Weighted& point : points) {
      squares += point.weight * (std::pow(u(point), 2) + std::pow(value(point) - first, 2));
    }
    return std::pair(first, std::sqrt(squares));
  };
  for (Index row = 0; row < mean.value.size(); ++row) {
    std::tie(mean.value[row], mean.u[row]) =
        together([&](const Weighted& point) { return point.response.value[row]; },
                 [&](const Weighted& point) { return point.response.u[row]; });
  }
  for (std::size_t s = 0; s < mean.sensors.size(); ++s) {
    SeriesSensor& sensor = mean.sensors[s];
    std::tie(sensor.gain, sensor.u_gain) =
        together([&](const Weighted& point) { return point.response.sensors[s].gain; },
                 [&](const Weighted& point) { return point.response.sensors[s].u_gain; });
    const auto at = static_cast<Index>(s);
    const auto [log_lag, u_log_lag] =
        together([&](const Weighted& point) { return point.theta[at]; },
                 [](const Weighted&) { return 0.0; });
    const double most_probable = points.front().theta[at];
    sensor.shortest = std::exp(std::min(log_lag - 2.0 * u_log_lag, most_probable));
    sensor.longest = std::exp(std::max(log_lag + 2.0 * u_log_lag, most_probable));
    sensor.lag_seen =
        most_probable < filter.High()[at] - kAtBound && most_probable > filter.Low()[at] + kAtBound;
  }
  return mean;
}

}  // namespace

SeriesResponse LearnResponse(const Series& series, const std::vector<bool>& held_out) {
  RefuseBad(series);
  const SeriesFilter filter(series, held_out);
  const VectorXd theta = Maximum([&](const VectorXd& at) { return filter.LogLikelihood(at); },
                                 filter.Start(), filter.Low(), filter.High(), kSeriesRounds);
  return MeanOf(filter, PointsAbout(filter, theta));
}

}  // namespace abbe::track
