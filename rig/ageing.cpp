#include "rig/ageing.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "rig/streams.h"

namespace abbe::rig {
namespace {

constexpr double kHoursOfDay = 24.0, kSecondsOfHour = 3600.0;
constexpr double kStepsOfDay = 4.0;    // of the walk
constexpr double kForgets = 1.0 / 96;  // of the wander, in an hour

// A seed for each step of the walk that no world has.
std::uint64_t SeedOfStep(std::uint64_t seed, std::uint64_t step) {
  return (seed + 1) * 0x9E3779B97F4A7C15ULL + step;
}

ErrorPopulation Times(ErrorPopulation population, double factor) {
  for (double* size :
       {&population.positioning, &population.straightness, &population.roll, &population.pitch,
        &population.yaw, &population.squareness, &population.scale}) {
    *size *= factor;
  }
  return population;
}

}  // namespace

Ageing::Ageing(const RigSettings& settings, std::uint64_t seed) : settings_(settings), seed_(seed) {
  const double at_start = settings_.temperature + settings_.ageing.swing * std::sin(1.0);
  room_ = {at_start};
  lagged_ = {at_start};
}

void Ageing::RefuseOutside(double day) {
  if (day >= 0.0 && day <= kLastDay) return;
  throw InputError(
      fmt::format("the rig ages from day 0 to day {:.0f}, not to {:g}", kLastDay, day));
}

void Ageing::ReachHour(std::size_t hour) const {
  const random::CounterRandom random(seed_, kRoomStream);
  const AgeingSettings& ageing = settings_.ageing;
  const double keep = 1.0 - kForgets;
  while (room_.size() <= hour) {
    const std::size_t next = room_.size();
    wander_ = keep * wander_ + ageing.wander * std::sqrt(1.0 - keep * keep) * random.Normal(next);
    const double angle = 1.0 + 2.0 * std::numbers::pi * static_cast<double>(next) / kHoursOfDay;
    const double before = room_.back();
    room_.push_back(settings_.temperature + ageing.swing * std::sin(angle) + wander_);
    // The exact response to a straight line over the hour.
    const double lag = ageing.lag / kSecondsOfHour, slope = room_.back() - before;
    lagged_.push_back(lag > 0.0 ? room_.back() - slope * lag +
                                      (lagged_.back() - before + slope * lag) * std::exp(-1.0 / lag)
                                : room_.back());
  }
}

double Ageing::TemperatureAt(double day) const {
  RefuseOutside(day);
  const double hours = day * kHoursOfDay;
  const auto hour = static_cast<std::size_t>(hours);
  ReachHour(hour + 1);
  return std::lerp(room_[hour], room_[hour + 1], hours - static_cast<double>(hour));
}

double Ageing::LaggedAt(double day) const {
  RefuseOutside(day);
  const double hours = day * kHoursOfDay;
  const auto hour = static_cast<std::size_t>(hours);
  ReachHour(hour + 1);
  const double since = hours - static_cast<double>(hour);
  const double lag = settings_.ageing.lag / kSecondsOfHour;
  const double now = std::lerp(room_[hour], room_[hour + 1], since);
  if (!(lag > 0.0)) return now;
  const double behind = (room_[hour + 1] - room_[hour]) * lag;
  return now - behind + (lagged_[hour] - room_[hour] + behind) * std::exp(-since / lag);
}

World Ageing::WorldAt(double day, const HiddenEffects& hidden, const Mounting& mounting) const {
  RigSettings now = settings_;
  now.temperature = TemperatureAt(day);
  World world(now, seed_, hidden, mounting);
  RigSettings walking = settings_;
  walking.population = Times(settings_.ageing.walk, 1.0 / std::sqrt(kStepsOfDay));
  walking.population.smoothness = settings_.population.smoothness;
  const double steps = day * kStepsOfDay;
  for (std::uint64_t step = 0; static_cast<double>(step) < steps; ++step) {
    const double share = std::min(1.0, steps - static_cast<double>(step));
    world.Wander(walking, SeedOfStep(seed_, step), share);
  }
  const double warmer =
      LaggedAt(day) - settings_.temperature - settings_.ageing.swing * std::sin(1.0);
  world.Warm(settings_.ageing.by_kelvin, warmer);
  return world;
}

}  // namespace abbe::rig
