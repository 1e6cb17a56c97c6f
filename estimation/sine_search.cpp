#include "estimation/sine_search.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "estimation/readings_at_rest.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd AboutMeans(const std::vector<Stay>& stays, const VectorXd& values) {
  VectorXd about = values;
  Index first = 0;
  for (const Stay& stay : stays) {
    auto own = about.segment(first, stay.value.size());
    own.array() -= own.mean();
    first += stay.value.size();
  }
  return about;
}

constexpr double kOfAWave = 0.4;  // over all readings, from one frequency to the next

// All readings about the means of their stays, held against sines of any frequency.
class StayReadings {
 public:
  explicit StayReadings(const std::vector<Stay>& stays) : stays_(stays) {
    Index count = 0;
    for (const Stay& stay : stays) count += stay.value.size();
    time_.resize(count);
    value_.resize(count);
    Index first = 0;
    for (const Stay& stay : stays) {
      time_.segment(first, stay.time.size()) = stay.time;
      value_.segment(first, stay.value.size()) = stay.value;
      first += stay.value.size();
    }
    value_ = AboutMeans(stays, value_);
    time_.array() -= time_[0];
  }

  double freedom() const {
    return static_cast<double>(value_.size()) - static_cast<double>(stays_.size());
  }
  double squares() const { return value_.squaredNorm(); }
  // The part of squares() that the best sine of a frequency takes.
  double ExplainedAt(double frequency) const { return BestAt(frequency).explained; }
  // That sine, about the means.
  VectorXd SineAt(double frequency) const { return BestAt(frequency).values; }

 private:
  struct Best {
    double explained = 0.0;
    VectorXd values;
  };

  Best BestAt(double frequency) const {
    const VectorXd phase = 2.0 * std::numbers::pi * frequency * time_;
    const VectorXd sine = AboutMeans(stays_, phase.array().sin());
    const VectorXd cosine = AboutMeans(stays_, phase.array().cos());
    Eigen::Matrix2d information;
    information << sine.squaredNorm(), sine.dot(cosine), sine.dot(cosine), cosine.squaredNorm();
    if (information.determinant() < 1e-6 * freedom() * freedom()) {
      return {0.0, VectorXd::Zero(value_.size())};
    }
    const Eigen::Vector2d score(sine.dot(value_), cosine.dot(value_));
    const Eigen::Vector2d amplitudes = information.inverse() * score;
    return {score.dot(amplitudes), amplitudes[0] * sine + amplitudes[1] * cosine};
  }

  const std::vector<Stay>& stays_;
  VectorXd time_, value_;
};

}  // namespace

std::vector<double> FrequenciesUpTo(double highest, double span) {
  constexpr double kMost = 20000.0;
  const double apart = std::max(kOfAWave / span, highest / kMost);
  std::vector<double> frequencies;
  for (double each = apart; each <= highest; each += apart) frequencies.push_back(each);
  return frequencies;
}

std::vector<double> FrequenciesOfMains(double span) {
  constexpr double kOff = 0.1, kClose = 0.25;  // Hz; of the step: an alias differs by little
  std::vector<double> frequencies;
  for (const double mains : kMains) {
    for (double off = -kOff; off <= kOff; off += kClose * kOfAWave / span)
      frequencies.push_back(mains + off);
  }
  return frequencies;
}

Sine StrongestSine(const std::vector<Stay>& stays, const std::vector<double>& frequencies) {
  constexpr int kBits = 26;  // of the frequency: half of those of a double, as flat as the top is
  const StayReadings readings(stays);
  Sine best;
  double most = 0.0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const double explained = readings.ExplainedAt(frequencies[i]);
    if (explained <= most) continue;
    most = explained;
    at = i;
  }
  const double freedom = readings.freedom();
  if (most == 0.0 || freedom <= 3.0) return best;
  double step = std::numeric_limits<double>::infinity();
  if (at > 0) step = frequencies[at] - frequencies[at - 1];
  if (at + 1 < frequencies.size()) step = std::min(step, frequencies[at + 1] - frequencies[at]);
  if (!std::isfinite(step)) step = 0.0;
  const auto [frequency, negative] = boost::math::tools::brent_find_minima(
      [&](double each) { return -readings.ExplainedAt(each); }, frequencies[at] - step,
      frequencies[at] + step, kBits);
  best.frequency = -negative > most ? frequency : frequencies[at];
  most = std::max(most, -negative);
  best.sd = std::sqrt(std::max(0.0, readings.squares() - most) / (freedom - 3.0));
  best.gain = -0.5 * freedom * std::log1p(-std::min(most / readings.squares(), 1.0 - 1e-12)) -
              std::log(static_cast<double>(frequencies.size()));
  return best;
}

std::vector<Stay> Without(const Sine& sine, std::vector<Stay> stays) {
  const VectorXd values = StayReadings(stays).SineAt(sine.frequency);
  Index first = 0;
  for (Stay& stay : stays) {
    stay.value -= values.segment(first, stay.value.size());
    first += stay.value.size();
  }
  return stays;
}

}  // namespace abbe::estimation
