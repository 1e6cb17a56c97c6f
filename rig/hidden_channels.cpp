#include "rig/hidden_channels.h"

#include <cmath>

#include "rig/hidden_motion.h"
#include "rig/noise.h"

namespace abbe::rig {
namespace {

constexpr std::uint64_t kSizesOfOutliers = 2000;  // index of draws

using Probe = std::function<double(const MachineState&)>;
using Pivot = std::function<double(const MachineState&, double)>;
using Said = std::function<double(double, double)>;

double WarmUpShare(double time, double time_constant) {
  return 1.0 - std::exp(-time / time_constant);
}

Probe Hum(double frequency, double amplitude, double phase) {
  return [=](const MachineState& state) {
    return amplitude * std::sin(kTurn * frequency * state.time + phase);
  };
}

Probe StepAndBack(double height, double from, double to) {
  return [=](const MachineState& state) {
    return state.time >= from && state.time < to ? height : 0.0;
  };
}

// Zero while its axis is swept: there it would be a part of the machine's own errors.
Probe IdleAxis(int axis, double amplitude, double period) {
  return [=](const MachineState& state) {
    return state.swept == axis ? 0.0 : amplitude * std::sin(kTurn * state.position[axis] / period);
  };
}

// The encoder reads half of the width too much along the motion of the pivot.
Pivot Hysteresis(double width) {
  return [play = Play(width)](const MachineState&, double turn) mutable {
    return turn - play.Follow(turn);
  };
}

Pivot Bump(double height, double centre, double width) {
  return [=](const MachineState&, double turn) {
    const double from = std::remainder(turn - centre, kTurn) / width;
    return height * std::exp(-0.5 * from * from);
  };
}

Pivot Wander(const random::CounterRandom& random, double deviation, double time_constant) {
  return [drift = SlowDrift(random, deviation, time_constant)](
             const MachineState& state, double) mutable { return drift.At(state.time); };
}

Said Stuck(double from, double to) {
  return [=, held = std::nan("")](double time, double value) mutable {
    if (!(time >= from && time < to)) return value;
    if (std::isnan(held)) held = value;
    return held;
  };
}

// One outlier at the first value at or after each instant, of random sign, uniform from `least` to
// ten times that.
Said Outliers(const HiddenEffect& effect, double least) {
  return [random = effect.random, instants = effect.instants, next = std::size_t{0}, least,
          begun = false](double time, double value) mutable {
    // Instants before the first value belong to another recording.
    while (!begun && next < instants.size() && instants[next] < time) ++next;
    begun = true;
    if (next >= instants.size() || !(instants[next] <= time)) return value;
    const std::uint64_t index = kSizesOfOutliers + next++;
    const double size = least * (1.0 + 9.0 * random.Uniform(index));
    return random.Bits(index)[3] % 2 == 0 ? value + size : value - size;
  };
}

}  // namespace

std::vector<ProbeAddition> ProbeAdditions(const HiddenEffects& hidden) {
  std::vector<ProbeAddition> additions;
  for (const HiddenEffect& e : hidden) {
    const auto add = [&](Probe gap) { additions.push_back({e.place(), std::move(gap)}); };
    switch (e.cause()) {
      case Cause::kMainsPickup:
        add(Hum(e.At("frequency_hz"), e.At("amplitude_um"), e.At("phase_rad")));
        break;
      case Cause::kWarmUpDrift:
        if (e.entry->objects != kProbeObject) break;
        add([amplitude = e.At("amplitude_um"),
             constant = e.At("time_constant_s")](const MachineState& state) {
          return amplitude * WarmUpShare(state.time, constant);
        });
        break;
      case Cause::kUnknownHum:
        add(Hum(1.0 / e.At("period_s"), e.At("amplitude_um"), e.At("phase_rad")));
        break;
      case Cause::kUnknownStepAndBack:
        add(StepAndBack(e.At("height_um"), e.At("from_s"), e.At("to_s")));
        break;
      case Cause::kUnknownWarmthSquare:
        add([height = e.At("height_um"), sensor = e.sensor](const MachineState& state) {
          return height * std::pow(state.warmth.at(sensor), 2);
        });
        break;
      case Cause::kUnknownIdleAxis:
        add(IdleAxis(static_cast<int>(e.At("axis")) - 1, e.At("amplitude_um"), e.At("period_mm")));
        break;
      default:
        break;
    }
  }
  return additions;
}

std::vector<PivotAddition> PivotAdditions(const HiddenEffects& hidden) {
  std::vector<PivotAddition> additions;
  for (const HiddenEffect& e : hidden) {
    const auto add = [&](Pivot angle, bool remembers = false) {
      additions.push_back({e.place(), std::move(angle), remembers});
    };
    switch (e.cause()) {
      case Cause::kWarmUpDrift:
        if (e.entry->objects != kPivotObject) break;
        add([amplitude = e.At("amplitude_urad"), constant = e.At("time_constant_s")](
                const MachineState& state, double) {
          return amplitude * WarmUpShare(state.time, constant);
        });
        break;
      case Cause::kEncoderCountSlip:
        add([angle = e.At("angle_urad"), time = e.At("time_s")](const MachineState& state, double) {
          return state.time >= time ? angle : 0.0;
        });
        break;
      case Cause::kJointHysteresis:
        add(Hysteresis(e.At("width_urad")), true);
        break;
      case Cause::kUnknownAngleBump:
        if (std::isnan(e.At("centre_rad"))) break;
        add(Bump(e.At("height_urad"), e.At("centre_rad"), e.At("width_rad")));
        break;
      case Cause::kUnknownWander:
        add(Wander(e.random, e.At("deviation_urad"), e.At("time_constant_s")));
        break;
      default:
        break;
    }
  }
  return additions;
}

std::vector<DataEffect> DataEffects(const HiddenEffects& hidden) {
  constexpr double kLeastGap = 1e-6, kLeastAngle = 100e-6;  // m, rad
  std::vector<DataEffect> effects;
  for (const HiddenEffect& e : hidden) {
    const bool probe = e.object.starts_with("probe_");
    if (e.cause() == Cause::kStuckChannel) {
      effects.push_back({probe, e.place(), Stuck(e.At("from_s"), e.At("to_s"))});
    } else if (e.cause() == Cause::kOutliers) {
      effects.push_back({probe, e.place(), Outliers(e, probe ? kLeastGap : kLeastAngle)});
    }
  }
  return effects;
}

Eigen::Vector3d DraggedBall::Follow(const Eigen::Vector3d& cap) {
  if (!begun_) ball_ = cap;
  begun_ = true;
  const Eigen::Vector3d from_cap = ball_ - cap;
  if (from_cap.norm() > displacement_) {
    ball_ = cap + displacement_ / from_cap.norm() * from_cap;
  }
  return ball_ - cap;
}

}  // namespace abbe::rig
