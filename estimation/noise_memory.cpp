#include "estimation/noise_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double MedianStep(const std::vector<Stay>& stays) {
  std::vector<double> steps;
  for (const Stay& stay : stays) {
    for (Index k = 1; k < stay.time.size(); ++k) steps.push_back(stay.time[k] - stay.time[k - 1]);
  }
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + (steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// Noise of deviation one; `share` of its variance has a memory.
NoiseMemory Shared(double share, double time) {
  return {std::sqrt(1.0 - share), std::sqrt(share), time};
}

// The restricted likelihood of the stays, their size at its best.
struct Likelihood {
  double logarithm = -std::numeric_limits<double>::infinity();
  double variance = 0.0;
};

Likelihood LikelihoodOf(const std::vector<Stay>& stays, const NoiseMemory& unit) {
  double squares = 0.0, determinants = 0.0, freedom = 0.0;
  for (const Stay& stay : stays) {
    const Index n = stay.value.size();
    if (n < 2) continue;
    const MemoryFilter filter(stay.time, unit);
    MatrixXd columns(n, 2);
    columns << stay.value.array() - stay.value.mean(), VectorXd::Ones(n);
    filter.Whiten(columns);
    const double of_mean = columns.col(1).squaredNorm();
    squares +=
        columns.col(0).squaredNorm() - std::pow(columns.col(0).dot(columns.col(1)), 2) / of_mean;
    determinants += filter.log_determinant() + std::log(of_mean);
    freedom += n - 1;
  }
  if (freedom < 1.0 || !(squares > 0.0)) return {};
  const double variance = squares / freedom;
  return {-0.5 * (freedom * std::log(variance) + determinants), variance};
}

}  // namespace

double NoiseMemory::sd() const { return std::hypot(white, slow); }

// 1 / (1 + 2 sum of the squares of the correlations).
double NoiseMemory::Independent(double step) const {
  const double share = std::pow(slow / sd(), 2), kept = std::exp(-2.0 * step / time);
  return 1.0 / (1.0 + 2.0 * share * share * kept / (1.0 - kept));
}

MemoryFilter::MemoryFilter(const VectorXd& times, const NoiseMemory& noise)
    : sd_(times.size()), gain_(times.size()), kept_(VectorXd::Zero(times.size())) {
  const double slow = noise.slow * noise.slow;
  double variance = slow;  // of the memory, by what was read before
  for (Index k = 0; k < times.size(); ++k) {
    const double of_reading = variance + noise.white * noise.white;
    sd_[k] = std::sqrt(of_reading);
    gain_[k] = variance / of_reading;
    variance -= gain_[k] * variance;
    if (k + 1 == times.size()) break;
    kept_[k] = std::exp(-(times[k + 1] - times[k]) / noise.time);
    variance = slow + kept_[k] * kept_[k] * (variance - slow);
  }
}

void MemoryFilter::Whiten(Eigen::Ref<MatrixXd> columns) const {
  Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(columns.cols());
  for (Index k = 0; k < columns.rows(); ++k) {
    columns.row(k) -= expected;
    expected = kept_[k] * (expected + gain_[k] * columns.row(k));
    columns.row(k) /= sd_[k];
  }
}

void MemoryFilter::Restore(Eigen::Ref<MatrixXd> columns) const {
  Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(columns.cols());
  for (Index k = 0; k < columns.rows(); ++k) {
    columns.row(k) *= sd_[k];
    const Eigen::RowVectorXd next = kept_[k] * (expected + gain_[k] * columns.row(k));
    columns.row(k) += expected;
    expected = next;
  }
}

void MemoryFilter::WhitenTransposed(Eigen::Ref<MatrixXd> columns) const {
  Eigen::RowVectorXd later = Eigen::RowVectorXd::Zero(columns.cols());
  for (Index k = columns.rows() - 1; k >= 0; --k) {
    const Eigen::RowVectorXd own = columns.row(k) / sd_[k];
    columns.row(k) = own + kept_[k] * gain_[k] * later;
    later = kept_[k] * (1.0 - gain_[k]) * later - own;
  }
}

double MemoryFilter::log_determinant() const { return 2.0 * sd_.array().log().sum(); }

// W' W is V^-1, and column k of W begins at row k.
VectorXd MemoryFilter::Weights() const {
  VectorXd weights(sd_.size());
  double later = 0.0;  // of the squares that a memory of one makes in the readings that follow
  for (Index k = sd_.size() - 1; k >= 0; --k) {
    const double own = 1.0 / (sd_[k] * sd_[k]);
    weights[k] = own + std::pow(kept_[k] * gain_[k], 2) * later;
    later = own + std::pow(kept_[k] * (1.0 - gain_[k]), 2) * later;
  }
  return weights;
}

double WhitePart(const std::vector<VectorXd>& channels) {
  constexpr double kMedian = 0.6745;  // of a normal number without its sign
  std::vector<double> differences;
  for (const VectorXd& one : channels) {
    for (Index i = 1; i + 1 < one.size(); ++i) {
      differences.push_back(std::abs(one[i - 1] - 2.0 * one[i] + one[i + 1]) / std::sqrt(6.0));
    }
  }
  if (differences.empty()) return 0.0;
  const auto middle = differences.begin() + std::ssize(differences) / 2;
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle / kMedian;
}

MemoryFit FitMemory(const std::vector<Stay>& stays) {
  constexpr double kLongest = 60.0, kRatio = 1.5;  // steps
  constexpr double kShares = 12.0;
  constexpr Index kFewest = 8;
  MemoryFit fit;
  fit.step = MedianStep(stays);
  Index readings = 0;
  for (const Stay& stay : stays) readings += stay.value.size();
  const Likelihood white = LikelihoodOf(stays, Shared(0.0, 1.0));
  fit.noise = {std::sqrt(white.variance), 0.0, 1.0};
  if (readings < kFewest || !(fit.step > 0.0)) return fit;
  Likelihood best = white;
  for (double steps = 1.0; steps <= kLongest; steps *= kRatio) {
    for (double i = 1.0; i <= kShares; ++i) {
      const double share = 1.0 - std::pow(1.0 - i / kShares, 2);
      const NoiseMemory unit = Shared(share, steps * fit.step);
      const Likelihood found = LikelihoodOf(stays, unit);
      if (found.logarithm <= best.logarithm) continue;
      best = found;
      const double size = std::sqrt(found.variance);
      fit.noise = {size * unit.white, size * unit.slow, unit.time};
    }
  }
  fit.gain = best.logarithm - white.logarithm;
  return fit;
}

}  // namespace abbe::estimation
