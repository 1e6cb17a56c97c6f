// Sweeps of the virtual rig straight into recordings: world, motion and noise by seed, the rows of
// the standstills only.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "rig/motion.h"
#include "rig/noise.h"
#include "rig/world.h"

namespace abbe::probes {

inline constexpr double kRowsPerSecond = 200.0;

inline rig::SweepMotion MotionOf(const rig::RigSettings& settings, int axis) {
  const hal::SweepPlan& plan = settings.sweeps[static_cast<std::size_t>(axis)].value();
  return {plan, {.acceleration = settings.acceleration, .lag = settings.lag}, plan.first()};
}

inline recording::Recording RecordRig(const rig::World& world, int axis) {
  const rig::RigSettings& settings = world.settings();
  const std::string letter(1, static_cast<char>('X' + axis));
  recording::Recording recording;
  recording.name = "rig_" + letter;
  recording.header =
      "kind = \"sweep\"\nmachine = \"" + settings.name + "\"\naxis = \"" + letter + "\"\n";
  for (const char* name : {"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction", "probe_a_um",
                           "probe_b_um", "probe_c_um", "probe_d_um", "probe_e_um", "flags"}) {
    recording.columns.push_back({name, {}});
  }
  const rig::SweepMotion motion = MotionOf(settings, axis);
  rig::SensorNoise noise(settings, world.seed(), static_cast<std::uint64_t>(axis));
  rig::Readings still{};
  double still_at = std::nan("");
  const auto last = static_cast<std::uint64_t>(motion.duration() * kRowsPerSecond);
  for (std::uint64_t tick = 0; tick <= last; ++tick) {
    const double time = static_cast<double>(tick) / kRowsPerSecond;
    const rig::MotionState state = motion.At(time);
    if (state.station < 0) continue;
    Eigen::Vector3d command = settings.StartOf(axis);
    command[axis] = state.position;
    if (!(std::abs(state.position - still_at) < 1e-12)) still = world.ReadingsAt(axis, command);
    still_at = state.position;
    std::vector<double> row = {time,
                               1e3 * command.x(),
                               1e3 * command.y(),
                               1e3 * command.z(),
                               1.0 * state.pass,
                               1.0 * state.direction};
    for (int probe = 0; probe < rig::kProbes; ++probe) {
      row.push_back(1e6 *
                    (still[static_cast<std::size_t>(probe)] + noise.OfProbe(probe, tick, time)));
    }
    row.push_back(0.0);
    for (std::size_t c = 0; c < row.size(); ++c) recording.columns[c].values.push_back(row[c]);
  }
  return recording;
}

}  // namespace abbe::probes
