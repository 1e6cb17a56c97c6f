#include "rig/live_machine.h"

#include <algorithm>
#include <cmath>

#include "settings/unit.h"

namespace abbe::rig {
namespace {

// The number of "probe_a_um", or -1.
int ProbeOf(std::string_view channel) {
  if (!channel.starts_with("probe_") || channel.size() < 8 || channel[7] != '_') return -1;
  const int probe = channel[6] - 'a';
  return probe >= 0 && probe < kProbes ? probe : -1;
}

// The number of "x_mm", or -1.
int AxisOf(std::string_view channel) {
  const bool position = channel.size() > 2 && channel[0] >= 'x' && channel[0] <= 'z' &&
                        channel[1] == '_' && !settings::UnitOf(channel).name.empty();
  return position ? channel[0] - 'x' : -1;
}

bool IsTemperature(std::string_view channel) {
  return channel.starts_with("temp_") && channel.ends_with("_c");
}

}  // namespace

LiveMachine::LiveMachine(const World& world)
    : world_(world), noise_(world.settings(), world.seed(), 0) {}

bool LiveMachine::Has(std::string_view channel) const {
  return ProbeOf(channel) >= 0 || AxisOf(channel) >= 0 || IsTemperature(channel);
}

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
  const double rate = world_.settings().update_rate;
  const auto tick = static_cast<std::uint64_t>(std::max(0.0, time) * rate);
  if (!latest_ || latest_->tick != tick) latest_ = Take(tick);
  const double unit = settings::UnitOf(channel).si;
  if (const int axis = AxisOf(channel); axis >= 0) return latest_->position[axis] / unit;
  if (const int probe = ProbeOf(channel); probe >= 0) {
    const double gap = latest_->gaps[probe];
    if (gap < 0.0 || gap > world_.settings().probes[probe].range) return std::nullopt;
    return gap / unit;
  }
  auto found = std::find(temperatures_.begin(), temperatures_.end(), channel);
  if (found == temperatures_.end()) {
    found = temperatures_.insert(temperatures_.end(), std::string(channel));
  }
  const auto sensor = static_cast<std::size_t>(found - temperatures_.begin());
  return world_.settings().temperature + noise_.OfTemperature(sensor, latest_->time);
}

}  // namespace abbe::rig
