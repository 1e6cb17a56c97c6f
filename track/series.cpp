#include "track/series.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

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
      response.sensors.push_back({series_.sensors[s], last.mean[1 + s],
                                  std::sqrt(last.covariance(1 + s, 1 + s)), std::exp(theta[s])});
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

}  // namespace

SeriesResponse LearnResponse(const Series& series, const std::vector<bool>& held_out) {
  RefuseBad(series);
  const SeriesFilter filter(series, held_out);
  const VectorXd theta = Maximum([&](const VectorXd& at) { return filter.LogLikelihood(at); },
                                 filter.Start(), filter.Low(), filter.High(), kSeriesRounds);
  return filter.Smooth(theta);
}

}  // namespace abbe::track
