// The noise of the rig's sensors as a function of time: white noise from one update to the next and
// a slow drift.
//
// White: one independent normal number for each probe and update. Drift: an Ornstein-Uhlenbeck
// process, covariance sd^2 * exp(-|t1 - t2| / time_constant), drawn on a grid of time by the exact
// recursion and joined by straight lines; between two grid points its variance is too small by at
// most step / (2 time_constant), 1 % or less. Every number is a pure function of (seed, run, time),
// so a value does not depend on other readings of the sensor.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "random/counter_random.h"
#include "rig/rig_settings.h"

namespace abbe::rig {

class SlowDrift {
 public:
  SlowDrift(const random::CounterRandom& random, double sd, double time_constant);

  // At a time of at least 0, s. Keeps no more than the last kKept to 2 kKept points of the grid; a
  // time before these draws it anew from the beginning.
  double At(double time);

 private:
  random::CounterRandom random_;
  double sd_;
  double step_;
  double kept_;                               // correlation of neighbouring grid points
  static constexpr std::size_t kKept = 4096;  // 7 min at least
  std::size_t first_ = 0;                     // the point that grid_ begins with
  std::vector<double> grid_;
};

// White noise of three channels, normal with this deviation: a function of the number of a row or
// an update. Takes three streams from `stream` on.
class WhiteNoise {
 public:
  WhiteNoise(std::uint64_t seed, std::uint64_t stream, double deviation)
      : seed_(seed), stream_(stream), deviation_(deviation) {}

  Eigen::Vector3d At(std::uint64_t number) const;

 private:
  std::uint64_t seed_, stream_;
  double deviation_;
};

// The seat of the ball in its cap, each direction normal with this deviation: drawn anew when the
// axes are more than 1 um from the last draw, so it is constant during a stay.
class BallSeat {
 public:
  // Takes three streams from `stream` on.
  BallSeat(std::uint64_t seed, std::uint64_t stream, double deviation)
      : noise_(seed, stream, deviation) {}

  Eigen::Vector3d At(const Eigen::Vector3d& axes);

 private:
  WhiteNoise noise_;
  std::uint64_t draws_ = 0;
  Eigen::Vector3d axes_, seat_;
};

// The noise of the five probes and of temperatures in one run. Two runs of one seed are
// independent.
class SensorNoise {
 public:
  SensorNoise(const RigSettings& settings, std::uint64_t seed, std::uint64_t run);

  // m, of one probe at the update `tick`, which is at `time`.
  double OfProbe(int probe, std::uint64_t tick, double time);
  // degC, of one temperature sensor. Time constant: an hour.
  double OfTemperature(std::size_t sensor, double time);

 private:
  std::uint64_t seed_, first_stream_;
  double white_;
  double temperature_drift_;
  std::vector<random::CounterRandom> white_random_;
  std::vector<SlowDrift> drifts_;
  std::vector<SlowDrift> temperatures_;
};

}  // namespace abbe::rig
