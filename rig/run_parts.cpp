#include "rig/run_parts.h"

#include <fmt/format.h>

#include <cmath>

#include "rig/rig_settings.h"

namespace abbe::rig {

OfState Lag(int axis, double delay) {
  return [=](const MachineState& state) { return -delay * state.velocity[axis]; };
}

OfState Wave(double frequency, double amplitude, double phase) {
  return [=](const MachineState& state) {
    return amplitude * std::sin(kTurn * frequency * state.time + phase);
  };
}

OfState WarmUp(double amplitude, double time_constant) {
  return [=](const MachineState& state) {
    return amplitude * (1.0 - std::exp(-state.time / time_constant));
  };
}

int ThirdAxis(const HiddenEffect& effect) { return kAxes - effect.places[0] - effect.places[1]; }

std::string PositionColumn(int axis) { return fmt::format("{:c}_mm", 'x' + axis); }

bool IsOfProbe(const HiddenEffect& effect) { return effect.object.starts_with("probe_"); }

}  // namespace abbe::rig
