#include "estimation/robust_mean.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "estimation/robust_loss.h"
#include "failure/failure.h"

namespace abbe::estimation {
namespace {

constexpr std::size_t kFewestForScale = 4;
constexpr int kMaxIterations = 200;
// Convergence, in scales: far below the standard error of any sample that fits in memory.
constexpr double kSettled = 1e-10;

struct Sample {
  std::span<const double> values;
  std::span<const double> deviations;  // empty: all 1

  std::size_t size() const { return values.size(); }
  double deviation(std::size_t i) const { return deviations.empty() ? 1.0 : deviations[i]; }
};

void Check(const Sample& sample) {
  if (sample.values.empty()) {
    throw NumericalError("robust mean: the sample is empty; at least one value is needed");
  }
  if (!sample.deviations.empty() && sample.deviations.size() != sample.size()) {
    throw NumericalError(
        fmt::format("robust mean: {} values but {} standard deviations; give one each",
                    sample.size(), sample.deviations.size()));
  }
  for (std::size_t i = 0; i < sample.size(); ++i) {
    if (!std::isfinite(sample.values[i])) {
      throw NumericalError(fmt::format(
          "robust mean: value {} of {} is not finite; leave bad readings out", i, sample.size()));
    }
    if (!(sample.deviation(i) > 0.0) || !std::isfinite(sample.deviation(i))) {
      throw NumericalError(fmt::format(
          "robust mean: standard deviation {} is {}; it must be above 0", i, sample.deviation(i)));
    }
  }
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + (values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  const double below = *std::max_element(values.begin(), middle);
  return below + (*middle - below) / 2.0;
}

// The m that minimises sum |x_i - m| / sigma_i.
double WeightedMedian(const Sample& sample) {
  if (sample.deviations.empty()) return Median({sample.values.begin(), sample.values.end()});
  std::vector<std::size_t> order(sample.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return sample.values[a] < sample.values[b]; });
  double total = 0.0;
  for (std::size_t i = 0; i < sample.size(); ++i) total += 1.0 / sample.deviation(i);
  double sum = 0.0;
  for (const auto i : order) {
    sum += 1.0 / sample.deviation(i);
    if (sum >= total / 2.0) return sample.values[i];
  }
  return sample.values[order.back()];
}

// Makes the MAD of n normal values unbiased (Croux and Rousseeuw).
double SmallSampleFactor(std::size_t n) {
  constexpr std::array<double, 10> kFactor = {1.0,   1.0,   1.196, 1.495, 1.363,
                                              1.206, 1.200, 1.140, 1.129, 1.107};
  return n < kFactor.size() ? kFactor[n] : n / (n - 0.8);
}

// The scale of absolute deviations from a centre: their median, or the lowest higher quantile that
// is not zero, divided by its value for a standard normal distribution.
double ScaleOf(std::vector<double> sizes) {
  struct Level {
    double share, normal;  // P(|t| < normal) = share
  };
  constexpr std::array<Level, 5> kLevels = {
      {{0.5, 0.674490}, {0.75, 1.150349}, {0.9, 1.644854}, {0.95, 1.959964}, {0.99, 2.575829}}};
  const double factor = SmallSampleFactor(sizes.size());
  const double median = Median(sizes);
  if (median > 0.0) return factor * median / kLevels[0].normal;
  std::sort(sizes.begin(), sizes.end());
  for (const Level& level : kLevels) {
    const auto at = static_cast<std::size_t>(level.share * (sizes.size() - 1));
    if (sizes[at] > 0.0) return factor * sizes[at] / level.normal;
  }
  return 0.0;
}

double ScaleAbout(const Sample& sample, double centre) {
  std::vector<double> sizes(sample.size());
  for (std::size_t i = 0; i < sample.size(); ++i) {
    sizes[i] = std::abs(sample.values[i] - centre) / sample.deviation(i);
  }
  return ScaleOf(std::move(sizes));
}

// The reweighted mean minus `centre`, computed as a difference so that constant data stay exact.
double Step(const Sample& sample, const RobustLoss& loss, double scale, double centre) {
  double sum = 0.0;
  double total = 0.0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double off = sample.values[i] - centre;
    const double sigma = sample.deviation(i);
    const double weight = loss.Weight(off / (scale * sigma)) / (sigma * sigma);
    sum += weight * off;
    total += weight;
  }
  return sum / total;
}

double Locate(const Sample& sample, const RobustLoss& loss, double scale, double centre) {
  for (int i = 0; i < kMaxIterations; ++i) {
    const double step = Step(sample, loss, scale, centre);
    centre += step;
    if (std::abs(step) <= kSettled * scale) break;
  }
  return centre;
}

void CountTails(const Sample& sample, const RobustMeanOptions& options, RobustMean& result) {
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double size = std::abs(sample.values[i] - result.mean) / sample.deviation(i);
    result.down_weighted += size > options.tuning * result.scale ? 1 : 0;
    result.outliers += size > options.outlier_at * result.scale ? 1 : 0;
  }
}

// Variance of the mean of normal data over that of Huber's mean: (E psi')^2 / E psi^2.
double HuberEfficiency(double k) {
  const double inside = std::erf(k / std::numbers::sqrt2);
  const double density = std::exp(-0.5 * k * k) / std::sqrt(2.0 * std::numbers::pi);
  const double square = inside - 2.0 * k * density + k * k * (1.0 - inside);
  return inside * inside / square;
}

double WeightSum(const Sample& sample) {
  double sum = 0.0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    sum += 1.0 / (sample.deviation(i) * sample.deviation(i));
  }
  return sum;
}

// scale^2 sum (psi/sigma)^2 / (sum psi'/sigma^2)^2 with n/(n-1) for the mean itself.
double StandardError(const Sample& sample, const RobustMean& result, double tuning) {
  double square = 0.0;
  double slope = 0.0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double sigma = sample.deviation(i);
    const double t = (sample.values[i] - result.mean) / (result.scale * sigma);
    const double psi = std::clamp(t, -tuning, tuning) / sigma;
    square += psi * psi;
    slope += std::abs(t) <= tuning ? 1.0 / (sigma * sigma) : 0.0;
  }
  if (slope <= 0.0) return result.scale / std::sqrt(WeightSum(sample));
  const double n = sample.size();
  return result.scale * std::sqrt(square * n / (n - 1.0)) / slope;
}

RobustMean PlainMean(const Sample& sample) {
  RobustMean result;
  result.count = sample.size();
  result.mean = sample.values[0] + Step(sample, RobustLoss::None(), 1.0, sample.values[0]);
  double square = 0.0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double t = (sample.values[i] - result.mean) / sample.deviation(i);
    square += t * t;
  }
  const double freedom = sample.size() - 1.0;
  result.scale =
      freedom > 0.0 ? std::sqrt(square / freedom) : std::numeric_limits<double>::infinity();
  result.standard_error = result.scale / std::sqrt(WeightSum(sample));
  return result;
}

RobustMean Estimate(const Sample& sample, const RobustMeanOptions& options) {
  Check(sample);
  const bool known = options.known_scale > 0.0;
  if (sample.size() < kFewestForScale && !known) return PlainMean(sample);
  RobustMean result;
  result.count = sample.size();
  result.mean = WeightedMedian(sample);
  result.scale = known ? options.known_scale : ScaleAbout(sample, result.mean);
  if (result.scale > 0.0) {
    result.mean = Locate(sample, RobustLoss::Huber(options.tuning), result.scale, result.mean);
    result.standard_error =
        known ? result.scale / std::sqrt(WeightSum(sample) * HuberEfficiency(options.tuning))
              : StandardError(sample, result, options.tuning);
  }
  CountTails(sample, options, result);
  return result;
}

}  // namespace

RobustMean HuberMean(std::span<const double> values, const RobustMeanOptions& options) {
  return Estimate({values, {}}, options);
}

RobustMean HuberMean(std::span<const double> values, std::span<const double> deviations,
                     const RobustMeanOptions& options) {
  return Estimate({values, deviations}, options);
}

double RobustScale(std::span<const double> values) {
  const Sample sample{values, {}};
  Check(sample);
  return ScaleAbout(sample, WeightedMedian(sample));
}

}  // namespace abbe::estimation
