// A machine that changes over days: its errors wander, and follow the temperature of the room
// behind a lag. The table [rig.ageing] of the machine file states how much.
//
//   const Ageing ageing(ReadRigSettings(root), seed);
//   const World world = ageing.WorldAt(7.25);          // a week and a quarter of a day later
//   ageing.TemperatureAt(7.25);                        // degC, of the room and of every sensor
//
// Walk: every six hours each error function, squareness and scale error gains an independent draw
// of the machine's own correlation length, half as large as what a day gains; between them it goes
// straight. Warmth: of each kelvin that the lagged temperature has changed since the start, a
// positioning error and an angle gain g1 s + g2 s^2 with s from 0 to 1 along the carriage's travel,
// a straightness an arc g1 (s^2 - s) and an S g2 (s^3 - 0.9 s), a squareness g. All g are drawn.
// The room: a daily wave and a wander that forgets in four days, stated hour by hour.
//
// Units: m, rad, degC, days since the start; key lag_s in s. Failure: InputError with file, line
// and key; for a day before the start or after kLastDay.
#pragma once

#include <cstdint>
#include <vector>

#include "rig/rig_settings.h"
#include "rig/world.h"

namespace abbe::rig {

inline constexpr double kLastDay = 400.0;

class Ageing {
 public:
  Ageing(const RigSettings& settings, std::uint64_t seed);

  double TemperatureAt(double day) const;
  // The temperature of the structure that follows, first-order lag.
  double LaggedAt(double day) const;

  // The machine as it is then, with its mean temperature.
  World WorldAt(double day, const HiddenEffects& hidden = {}, const Mounting& mounting = {}) const;

 private:
  void ReachHour(std::size_t hour) const;
  static void RefuseOutside(double day);

  RigSettings settings_;
  std::uint64_t seed_;
  mutable std::vector<double> room_, lagged_;  // hour by hour
  mutable double wander_ = 0.0;
};

}  // namespace abbe::rig
