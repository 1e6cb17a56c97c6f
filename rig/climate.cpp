#include "rig/climate.h"

#include <algorithm>

namespace abbe::rig {

double Climate::At(std::string_view sensor, double time) {
  auto found = std::find(sensors_.begin(), sensors_.end(), sensor);
  if (found == sensors_.end()) found = sensors_.insert(sensors_.end(), std::string(sensor));
  const std::size_t index = found - sensors_.begin();
  return mean_ + warmer_ + noise_.OfTemperature(index, time);
}

}  // namespace abbe::rig
