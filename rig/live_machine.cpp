#include "rig/live_machine.h"

#include <algorithm>
#include <cmath>

#include "rig/rig_channel.h"

namespace abbe::rig {
LiveMachine::LiveMachine(const World& world)
    : world_(world), noise_(world.settings(), world.seed(), 0) {}

bool LiveMachine::Start(int axis, double time) {
  const RigSettings& settings = world_.settings();
  if (StateAt(time) == ProgramState::kRunning || !settings.sweeps[axis]) return false;
  axis_ = axis;
  started_ = time;
  motion_.emplace(*settings.sweeps[axis], Dynamics{settings.acceleration, settings.lag},
                  settings.travels[axis].first);
  latest_.reset();
  return true;
}

ProgramState LiveMachine::StateAt(double time) const {
  if (!motion_) return ProgramState::kIdle;
  return time < started_ + motion_->duration() ? ProgramState::kRunning : ProgramState::kDone;
}

LiveMachine::Snapshot LiveMachine::Take(std::uint64_t tick) {
  const RigSettings& settings = world_.settings();
  Snapshot snapshot{tick, static_cast<double>(tick) / settings.update_rate, {}, {}};
  for (int axis = 0; axis < kAxes; ++axis) snapshot.position[axis] = settings.travels[axis].first;
  if (motion_) snapshot.position[axis_] = motion_->At(snapshot.time - started_).position;
  snapshot.gaps = world_.ReadingsAt(axis_, snapshot.position);
  for (int probe = 0; probe < kProbes; ++probe) {
    snapshot.gaps[probe] += noise_.OfProbe(probe, tick, snapshot.time);
  }
  return snapshot;
}

std::optional<double> LiveMachine::ReadingOf(std::string_view channel, double time) {
  const std::optional<RigChannel> parsed = ParseChannel(channel);
  if (!parsed) return std::nullopt;
  const double rate = world_.settings().update_rate;
  const auto tick = static_cast<std::uint64_t>(std::max(0.0, time) * rate);
  if (!latest_ || latest_->tick != tick) latest_ = Take(tick);
  if (parsed->quantity == RigChannel::Quantity::kPosition) {
    return latest_->position[parsed->index] / parsed->unit;
  }
  if (parsed->quantity == RigChannel::Quantity::kGap) {
    const double gap = latest_->gaps[parsed->index];
    if (gap < 0.0 || gap > world_.settings().probes[parsed->index].range) return std::nullopt;
    return gap / parsed->unit;
  }
  auto found = std::find(temperatures_.begin(), temperatures_.end(), channel);
  if (found == temperatures_.end()) {
    found = temperatures_.insert(temperatures_.end(), std::string(channel));
  }
  const auto sensor = static_cast<std::size_t>(found - temperatures_.begin());
  return world_.settings().temperature + noise_.OfTemperature(sensor, latest_->time);
}

}  // namespace abbe::rig
