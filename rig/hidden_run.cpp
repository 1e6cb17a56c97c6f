#include "rig/hidden_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rig/rig_settings.h"

namespace abbe::rig {
namespace {

constexpr double kMotion = 1e-8;  // m: an axis has turned when it has come back by more

}  // namespace

HiddenRun::HiddenRun(const HiddenEffects& effects, Climate& climate, const About& about)
    : climate_(climate), begin_(about.begin), empty_(effects.empty()) {
  state_.swept = about.swept;
  for (const HiddenEffect& effect : effects) {
    if (!effect.sensor.empty()) at_start_[effect.sensor] = climate.AtStart(effect.sensor);
    if (effect.entry->in_run != nullptr) effect.entry->in_run(effect, parts_);
  }
  remembers_turns_ = std::any_of(parts_.pivots.begin(), parts_.pivots.end(),
                                 [](const auto& each) { return each.has_history; });
}

void HiddenRun::Turn(int axis, double position) {
  double& direction = state_.direction[axis];
  double& farthest = farthest_[axis];
  if (direction == 0.0) {
    if (std::abs(position - farthest) <= kMotion) return;
    direction = position > farthest ? 1.0 : -1.0;
    farthest = position;
  } else if (direction * (position - farthest) >= 0.0) {
    state_.since_turn[axis] += std::abs(position - farthest);
    farthest = position;
  } else if (std::abs(position - farthest) > kMotion) {
    direction = -direction;
    state_.since_turn[axis] = std::abs(position - farthest);
    farthest = position;
  }
}

void HiddenRun::Follow(double time, const Eigen::Vector3d& position,
                       const Eigen::Vector3d& velocity) {
  state_.time = begin_ + time;
  state_.position = place_ = position;
  state_.velocity = velocity;
  if (empty_) return;
  if (!begun_) farthest_ = position;
  begun_ = true;
  for (int axis = 0; axis < kAxes; ++axis) Turn(axis, position[axis]);
  for (const auto& [sensor, start] : at_start_) {
    state_.warmth[sensor] = climate_.At(sensor, state_.time) - start;
  }
  for (auto& each : parts_.shifts) place_[each.axis] += each.shift(state_);
}

Eigen::Vector3d HiddenRun::PlaceFor(Source source) const {
  const double late = parts_.late[static_cast<std::size_t>(source)];
  if (late == 0.0) return place_;
  return place_ - late * state_.velocity;
}

void HiddenRun::Say(Readings& gaps) {
  if (empty_) return;
  for (const auto& each : parts_.probes) gaps[each.probe] += each.gap(state_);
  for (const auto& [first, second] : parts_.swapped) std::swap(gaps[first], gaps[second]);
  for (auto& each : parts_.data) {
    if (each.probe) gaps[each.index] = each.said(state_.time, gaps[each.index]);
  }
}

Eigen::Vector3d HiddenRun::BallFrom(const Eigen::Vector3d& cap) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  for (DraggedBall& ball : parts_.balls) from += ball.Follow(cap);
  return from;
}

Eigen::Vector3d HiddenRun::EncodersShow(const Eigen::Vector3d& turns) {
  Eigen::Vector3d beside = Eigen::Vector3d::Zero();
  for (auto& each : parts_.pivots) beside[each.pivot] += each.angle(state_, turns[each.pivot]);
  return beside;
}

bool HiddenRun::WantsTurns() {
  constexpr double kStep = 0.05;  // s
  if (!remembers_turns_ || state_.time < next_turns_) return false;
  next_turns_ = state_.time + kStep;
  return true;
}

void HiddenRun::Say(Eigen::Vector3d& angles) {
  for (auto& each : parts_.data) {
    if (!each.probe) angles[each.index] = each.said(state_.time, angles[each.index]);
  }
}

}  // namespace abbe::rig
