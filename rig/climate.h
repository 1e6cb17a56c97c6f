// The temperatures around the machine: a mean and a slow drift of each sensor (noise.h), and an
// offset of all of them.
//
// A sensor is identified by the name of its column; a new name gets the next random stream. Time is
// s since the start of the recording, or of the campaign whose recordings share a climate. degC.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rig/noise.h"
#include "rig/rig_settings.h"

namespace abbe::rig {

class Climate {
 public:
  Climate(const RigSettings& settings, std::uint64_t seed, std::uint64_t run,
          std::vector<std::string> sensors)
      : mean_(settings.temperature), noise_(settings, seed, run), sensors_(std::move(sensors)) {}

  double At(std::string_view sensor, double time);
  // At time 0, without the offset.
  double AtStart(std::string_view sensor) { return At(sensor, 0.0) - warmer_; }
  // Sets the offset of all sensors from now on, K; 0 at first.
  void Warm(double warmer) { warmer_ = warmer; }

 private:
  double mean_, warmer_ = 0.0;
  SensorNoise noise_;
  std::vector<std::string> sensors_;
};

}  // namespace abbe::rig
