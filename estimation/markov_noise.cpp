#include "estimation/markov_noise.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "failure/failure.h"

namespace abbe::estimation {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr Eigen::Index kColumnsAtOnce = 16;  // right-hand sides solved in one pass over time

struct Readings {
  std::span<const double> times;
  std::span<const int> groups;
  const Eigen::MatrixXd& values;
  std::span<const double> white;
  int group_count;
  Eigen::Index size() const { return values.rows(); }
};

void CheckLengths(const Readings& readings) {
  const Eigen::Index k = std::ssize(readings.times);
  if (std::ssize(readings.groups) != k || std::ssize(readings.white) != k || readings.size() != k) {
    throw InputError(
        fmt::format("drift fit: {} times, {} groups, {} rows of values, {} variances; give one of "
                    "each per reading",
                    k, readings.groups.size(), readings.size(), readings.white.size()));
  }
}

void CheckReading(const Readings& readings, std::size_t k) {
  if (!std::isfinite(readings.times[k]) ||
      (k > 0 && !(readings.times[k] > readings.times[k - 1]))) {
    throw InputError(
        fmt::format("drift fit: time {} of reading {} is not after the one before; sort by time",
                    readings.times[k], k));
  }
  if (readings.groups[k] < 0 || readings.groups[k] >= readings.group_count) {
    throw InputError(fmt::format("drift fit: reading {} is of group {}, groups are 0 to {}", k,
                                 readings.groups[k], readings.group_count - 1));
  }
  if (!(readings.white[k] > 0.0) || !std::isfinite(readings.white[k])) {
    throw InputError(fmt::format("drift fit: white variance {} of reading {} must be above 0",
                                 readings.white[k], k));
  }
  if (!readings.values.row(k).allFinite()) {
    throw InputError(fmt::format("drift fit: reading {} is not finite; leave bad readings out", k));
  }
}

void Check(const Readings& readings, double drift_sd, double drift_time) {
  CheckLengths(readings);
  std::vector<bool> seen(std::max(readings.group_count, 0));
  for (std::size_t k = 0; k < readings.times.size(); ++k) {
    CheckReading(readings, k);
    seen[readings.groups[k]] = true;
  }
  const auto missing = std::find(seen.begin(), seen.end(), false);
  if (missing != seen.end() || seen.empty()) {
    throw InputError(
        fmt::format("drift fit: group {} has no reading; number only groups that have one",
                    missing - seen.begin()));
  }
  if (!(drift_sd >= 0.0) || (drift_sd > 0.0 && !(drift_time > 0.0))) {
    throw InputError(
        fmt::format("drift fit: drift of standard deviation {} and correlation time {} s; give sd "
                    ">= 0, time > 0",
                    drift_sd, drift_time));
  }
}

// V = W + s^2 R, applied as V^-1 through the tridiagonal M = W^-1 + (s^2 R)^-1 = L D L'.
class DriftCovariance {
 public:
  DriftCovariance(const Readings& readings, double sd, double time)
      : white_(readings.white), drifts_(sd > 0.0) {
    for (const double w : white_) log_determinant_ += std::log(w);
    if (drifts_) Factorise(readings.times, sd * sd, time);
  }

  double log_determinant() const { return log_determinant_; }

  // The expected drift in `y`, in place: M^-1 W^-1 y.
  void Smooth(RowMatrix& y) const {
    if (!drifts_) {
      y.setZero();
      return;
    }
    const Eigen::Index n = y.rows();
    for (Eigen::Index k = 0; k < n; ++k) {
      y.row(k) /= white_[k];
      if (k > 0) y.row(k) -= lower_[k] * y.row(k - 1);
    }
    y.row(n - 1) /= pivot_[n - 1];
    for (Eigen::Index k = n - 2; k >= 0; --k) {
      y.row(k) = y.row(k) / pivot_[k] - lower_[k + 1] * y.row(k + 1);
    }
  }

  // V^-1 y = W^-1 (y - drift of y).
  RowMatrix Solve(const RowMatrix& y) const {
    RowMatrix smooth = y;
    Smooth(smooth);
    RowMatrix result = y - smooth;
    for (Eigen::Index k = 0; k < y.rows(); ++k) {
      result.row(k) /= white_[k];
    }
    return result;
  }

 private:
  void Factorise(std::span<const double> times, double variance, double time) {
    const Eigen::Index n = times.size();
    Eigen::VectorXd diagonal(n);
    lower_.setZero(n);
    pivot_.resize(n);
    log_determinant_ += std::log(variance);
    diagonal[0] = 1.0 / white_[0] + 1.0 / variance;
    for (Eigen::Index k = 1; k < n; ++k) {
      const double lag = (times[k] - times[k - 1]) / time;
      const double rho = std::exp(-lag);
      const double step = -variance * std::expm1(-2.0 * lag);  // s^2 (1 - rho^2)
      diagonal[k] = 1.0 / white_[k] + 1.0 / step;
      diagonal[k - 1] += rho * rho / step;
      lower_[k] = -rho / step;
      log_determinant_ += std::log(step);
    }
    for (Eigen::Index k = 0; k < n; ++k) {
      pivot_[k] = diagonal[k];
      if (k > 0) {
        const double off = lower_[k];
        lower_[k] = off / pivot_[k - 1];
        pivot_[k] -= lower_[k] * off;
      }
      log_determinant_ += std::log(pivot_[k]);
    }
  }

  std::span<const double> white_;
  bool drifts_;
  Eigen::VectorXd lower_, pivot_;
  double log_determinant_ = 0.0;  // of V
};

// A' x, A the 0/1 matrix of membership: reading k, group g.
Eigen::MatrixXd SumByGroup(const Readings& readings, const RowMatrix& x) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(readings.group_count, x.cols());
  for (Eigen::Index k = 0; k < x.rows(); ++k) {
    sum.row(readings.groups[k]) += x.row(k);
  }
  return sum;
}

RowMatrix SpreadToReadings(const Readings& readings, const Eigen::MatrixXd& of_groups) {
  RowMatrix x(readings.size(), of_groups.cols());
  for (Eigen::Index k = 0; k < x.rows(); ++k) {
    x.row(k) = of_groups.row(readings.groups[k]);
  }
  return x;
}

// A' V^-1 A, a few groups at a time.
Eigen::MatrixXd GroupInformation(const Readings& readings, const DriftCovariance& covariance) {
  const Eigen::Index groups = readings.group_count;
  Eigen::MatrixXd information(groups, groups);
  for (Eigen::Index first = 0; first < groups; first += kColumnsAtOnce) {
    const Eigen::Index count = std::min(kColumnsAtOnce, groups - first);
    Eigen::MatrixXd chosen = Eigen::MatrixXd::Zero(groups, count);
    chosen.middleRows(first, count).setIdentity();
    information.middleCols(first, count) =
        SumByGroup(readings, covariance.Solve(SpreadToReadings(readings, chosen)));
  }
  return 0.5 * (information + information.transpose());
}

}  // namespace

MarkovNoiseFit FitGroupsUnderDrift(std::span<const double> times, std::span<const int> groups,
                                   const Eigen::MatrixXd& values,
                                   std::span<const double> white_variances, double drift_sd,
                                   double drift_time, int group_count) {
  const Readings readings{times, groups, values, white_variances, group_count};
  Check(readings, drift_sd, drift_time);
  const DriftCovariance covariance(readings, drift_sd, drift_time);
  const Eigen::LLT<Eigen::MatrixXd> information(GroupInformation(readings, covariance));
  if (information.info() != Eigen::Success) {
    throw NumericalError(
        fmt::format("drift fit: the {} group values cannot be separated from a drift of "
                    "standard deviation {}; state a smaller one",
                    group_count, drift_sd));
  }
  MarkovNoiseFit fit;
  fit.freedom = readings.size() - group_count;
  fit.values = information.solve(SumByGroup(readings, covariance.Solve(values)));
  fit.covariance = information.solve(Eigen::MatrixXd::Identity(group_count, group_count));
  const RowMatrix off = values - SpreadToReadings(readings, fit.values);
  RowMatrix drift = off;
  covariance.Smooth(drift);
  fit.drift = drift;
  fit.residuals = off - drift;
  fit.chi_square = off.cwiseProduct(covariance.Solve(off)).colwise().sum().transpose();
  const double log_information =
      2.0 * information.matrixLLT().diagonal().array().log().sum();  // of |A' V^-1 A|
  const double constant = fit.freedom * std::log(2.0 * std::numbers::pi) +
                          covariance.log_determinant() + log_information;
  fit.log_restricted_likelihood = -0.5 * (fit.chi_square.array() + constant);
  return fit;
}

}  // namespace abbe::estimation
