#include "rig/noise.h"

#include <algorithm>
#include <cmath>

#include "rig/streams.h"

namespace abbe::rig {
namespace {

constexpr double kLongestStep = 0.1;         // s, between grid points at most
constexpr double kStepsPerConstant = 50.0;   // and at least so many in a time constant
constexpr double kTemperatureTime = 3600.0;  // s

}  // namespace

SlowDrift::SlowDrift(const random::CounterRandom& random, double sd, double time_constant)
    : random_(random),
      sd_(sd),
      step_(std::min(kLongestStep, time_constant / kStepsPerConstant)),
      kept_(std::exp(-step_ / time_constant)) {}

double SlowDrift::At(double time) {
  const double place = time / step_;
  const auto before = static_cast<std::size_t>(place);
  const double fresh = std::sqrt(1.0 - kept_ * kept_);
  if (before < first_) {
    grid_.clear();
    first_ = 0;
  }
  while (first_ + grid_.size() < before + 2) {
    if (grid_.size() >= 2 * kKept) {
      grid_.erase(grid_.begin(), grid_.begin() + kKept);
      first_ += kKept;
    }
    const double normal = random_.Normal(first_ + grid_.size());
    grid_.push_back(grid_.empty() ? sd_ * normal : kept_ * grid_.back() + sd_ * fresh * normal);
  }
  const double share = place - before;
  return (1.0 - share) * grid_[before - first_] + share * grid_[before - first_ + 1];
}

Eigen::Vector3d WhiteNoise::At(std::uint64_t number) const {
  Eigen::Vector3d noise;
  for (std::uint64_t i = 0; i < 3; ++i) {
    noise[i] = deviation_ * random::CounterRandom(seed_, stream_ + i).Normal(number);
  }
  return noise;
}

Eigen::Vector3d BallSeat::At(const Eigen::Vector3d& axes) {
  constexpr double kMoved = 1e-6;  // m
  if (draws_ == 0 || (axes - axes_).norm() > kMoved) {
    axes_ = axes;
    seat_ = noise_.At(draws_++);
  }
  return seat_;
}

SensorNoise::SensorNoise(const RigSettings& settings, std::uint64_t seed, std::uint64_t run)
    : seed_(seed),
      first_stream_(kRunStreams * run),
      white_(settings.white),
      temperature_drift_(settings.temperature_drift) {
  for (std::uint64_t probe = 0; probe < kProbes; ++probe) {
    white_random_.emplace_back(seed, kNoiseStream + first_stream_ + probe);
    drifts_.emplace_back(random::CounterRandom(seed, kDriftStream + first_stream_ + probe),
                         settings.drift, settings.drift_time);
  }
}

double SensorNoise::OfProbe(int probe, std::uint64_t tick, double time) {
  return white_ * white_random_[probe].Normal(tick) + drifts_[probe].At(time);
}

double SensorNoise::OfTemperature(std::size_t sensor, double time) {
  while (temperatures_.size() <= sensor) {
    const std::uint64_t stream = kTemperatureStream + first_stream_ + temperatures_.size();
    temperatures_.emplace_back(random::CounterRandom(seed_, stream), temperature_drift_,
                               kTemperatureTime);
  }
  return temperatures_[sensor].At(time);
}

}  // namespace abbe::rig
