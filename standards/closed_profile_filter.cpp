#include "standards/closed_profile_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "failure/failure.h"

namespace abbe::standards {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// In units of a w, the width of the weight function: beyond it a weight is below 1e-14.
constexpr double kReach = 3.3;

struct Reading {
  double angle;  // 0 to a turn
  double value;
  std::size_t place;
};

std::vector<Reading> Sorted(std::span<const double> angles, std::span<const double> values) {
  std::vector<Reading> readings(angles.size());
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (!std::isfinite(angles[i]) || !std::isfinite(values[i])) {
      throw InputError(fmt::format("filter, reading {}: angle {}, value {}: give finite numbers",
                                   i + 1, angles[i], values[i]));
    }
    readings[i] = {angles[i] - kTurn * std::floor(angles[i] / kTurn), values[i], i};
  }
  std::ranges::sort(readings, {}, &Reading::angle);
  return readings;
}

}  // namespace

std::vector<double> FilterClosedProfile(std::span<const double> angles,
                                        std::span<const double> values, double cutoff) {
  if (angles.size() != values.size() || !(cutoff > 0.0)) {
    throw InputError(
        fmt::format("filter of {} angles and {} values at {} undulations per turn: give lists of "
                    "equal length and a cutoff above 0",
                    angles.size(), values.size(), cutoff));
  }
  const std::vector<Reading> readings = Sorted(angles, values);
  const std::size_t n = readings.size();
  const double width = std::sqrt(std::numbers::ln2 / std::numbers::pi) * kTurn / cutoff;
  const double reach = std::min(kReach * width, kTurn / 2.0);
  std::vector<double> smooth(n);
  for (std::size_t i = 0; i < n; ++i) {
    double weights = 0.0, sum = 0.0;
    const auto add = [&](std::size_t k, double distance) {
      const double bell = distance / width;
      const double weight = std::exp(-std::numbers::pi * bell * bell);
      weights += weight;
      sum += weight * readings[k].value;
    };
    add(i, 0.0);
    for (std::size_t step = 1; step < n; ++step) {
      const std::size_t k = (i + step) % n;
      const double distance = readings[k].angle - readings[i].angle + (k < i ? kTurn : 0.0);
      if (distance > reach) break;
      add(k, distance);
    }
    for (std::size_t step = 1; step < n; ++step) {
      const std::size_t k = (i + n - step) % n;
      const double distance = readings[i].angle - readings[k].angle + (k > i ? kTurn : 0.0);
      if (distance >= reach) break;
      add(k, distance);
    }
    smooth[readings[i].place] = sum / weights;
  }
  return smooth;
}

}  // namespace abbe::standards
