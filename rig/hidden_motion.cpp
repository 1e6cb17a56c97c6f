#include "rig/hidden_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "rig/rig_settings.h"
#include "settings/unit.h"

namespace abbe::rig {
namespace {

using Shift = std::function<double(const MachineState&)>;

constexpr std::uint64_t kFreePhase = 1000;  // index of the draw of a phase that is no key

Shift Backlash(int axis, double width) {
  return [axis, play = Play(width)](const MachineState& state) mutable {
    return play.Follow(state.position[axis]) - state.position[axis];
  };
}

Shift Cyclic(int axis, double pitch, double amplitude, double phase) {
  return [=](const MachineState& state) {
    return amplitude * std::sin(kTurn * state.position[axis] / pitch + phase);
  };
}

Shift Growth(int axis, double coefficient, const std::string& sensor) {
  return [=](const MachineState& state) {
    return coefficient * state.warmth.at(sensor) * state.position[axis];
  };
}

Shift Lag(int axis, double delay) {
  return [=](const MachineState& state) { return -delay * state.velocity[axis]; };
}

Shift Spike(int axis, double height, double decay) {
  return [=](const MachineState& state) {
    return -state.direction[axis] * height * std::exp(-state.since_turn[axis] / decay);
  };
}

Shift WarmUp(double amplitude, double time_constant) {
  return [=](const MachineState& state) {
    return amplitude * (1.0 - std::exp(-state.time / time_constant));
  };
}

Shift ShakenMotion(double frequency, double amplitude, double phase) {
  return [=](const MachineState& state) {
    return amplitude * std::sin(kTurn * frequency * state.time + phase);
  };
}

// The third axis drops with the product of two.
Shift Load(const std::vector<int>& pair, double coefficient) {
  return [=](const MachineState& state) {
    return -coefficient * state.position[pair[0]] * state.position[pair[1]];
  };
}

Shift Diagonal(const std::vector<int>& pair, double period, double amplitude, double phase) {
  return [=](const MachineState& state) {
    const double sum = state.position[pair[0]] + state.position[pair[1]];
    return amplitude * std::sin(kTurn * sum / period + phase);
  };
}

// `height` at 600 mm/min along the path.
Shift FeedSquare(double height) {
  const double unit = 600.0 * settings::UnitOf("feed_mm_min").si;
  return [=](const MachineState& state) {
    return height * state.velocity.squaredNorm() / (unit * unit);
  };
}

}  // namespace

double Play::Follow(double drive) {
  driven_ = begun_ ? std::clamp(driven_, drive - half_, drive + half_) : drive;
  begun_ = true;
  return driven_;
}

std::vector<AxisShift> AxisShifts(const HiddenEffects& hidden) {
  std::vector<AxisShift> shifts;
  for (const HiddenEffect& e : hidden) {
    const int axis = e.place();
    const auto add = [&](int on, Shift shift) { shifts.push_back({on, std::move(shift)}); };
    const auto third = [&] { return kAxes - e.places[0] - e.places[1]; };
    switch (e.cause()) {
      case Cause::kBacklash:
        add(axis, Backlash(axis, e.At("width_um")));
        break;
      case Cause::kLeadscrewCyclic:
        add(axis, Cyclic(axis, e.At("pitch_mm"), e.At("amplitude_um"), e.At("phase_rad")));
        break;
      case Cause::kScaleError:
        add(axis, [axis, gain = e.At("gain_ppm")](const MachineState& state) {
          return gain * state.position[axis];
        });
        break;
      case Cause::kThermalGrowth:
        add(axis, Growth(axis, e.At("coefficient_ppm_per_c"), e.sensor));
        break;
      case Cause::kWarmUpDrift:
        if (e.entry->objects != kAxisObject) break;
        add(axis, WarmUp(e.At("amplitude_um"), e.At("time_constant_s")));
        break;
      case Cause::kServoLag:
        add(axis, Lag(axis, e.At("delay_ms")));
        break;
      case Cause::kServoLagMismatch:
        add(e.places[0], Lag(e.places[0], -0.5 * e.At("delay_ms")));
        add(e.places[1], Lag(e.places[1], 0.5 * e.At("delay_ms")));
        break;
      case Cause::kReversalSpike:
        add(axis, Spike(axis, e.At("height_um"), e.At("decay_mm")));
        break;
      case Cause::kVibration:
        add(axis, ShakenMotion(e.At("frequency_hz"), e.At("amplitude_um"),
                               e.random.Uniform(kFreePhase, 0.0, kTurn)));
        break;
      case Cause::kLoadCoupling:
        add(third(), Load(e.places, e.At("coefficient_nm_per_mm2")));
        break;
      case Cause::kUnknownFeedSquare:
        add(axis, FeedSquare(e.At("height_um")));
        break;
      case Cause::kUnknownDiagonalRipple:
        add(third(),
            Diagonal(e.places, e.At("period_mm"), e.At("amplitude_um"), e.At("phase_rad")));
        break;
      default:
        break;
    }
  }
  return shifts;
}

}  // namespace abbe::rig
