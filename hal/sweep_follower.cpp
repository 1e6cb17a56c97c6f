#include "hal/sweep_follower.h"

#include <algorithm>
#include <cmath>

namespace abbe::hal {

SweepFollower::SweepFollower(const SweepPlan& plan)
    : plan_(plan), visits_(plan.Visits()), done_(visits_.size(), false) {}

const SweepState& SweepFollower::Step(std::optional<double> position, double time_s, bool good) {
  if (steps_++ == 0) last_motion_s_ = time_s;
  if (!position) return state_;
  if (!seen_) {
    seen_ = true;
    extreme_ = rest_ = *position;
  }
  if (std::abs(*position - rest_) > plan_.window) {
    rest_ = *position;
    last_motion_s_ = time_s;
  }
  FollowDirection(*position);
  FollowStation(*position, time_s);
  CountVisit(time_s, good);
  const bool left_the_last = done_.back() && !state_.station && state_.pass == plan_.passes;
  complete_ = complete_ || left_the_last;  // a program may leave before the whole dwell is over
  return state_;
}

void SweepFollower::FollowDirection(double position) {
  const double turn = 2.0 * plan_.window;
  const double middle = 0.5 * (plan_.first() + plan_.last());
  was_upper_ = was_upper_ || position > middle;
  int direction = state_.direction;
  if (direction == 0) {
    if (std::abs(position - extreme_) > turn) direction = position > extreme_ ? 1 : -1;
  } else if (direction * (extreme_ - position) > turn) {
    direction = -direction;
  }
  if (direction != state_.direction) {
    const bool at_the_low_end = direction > 0 && extreme_ < middle;
    if (at_the_low_end && (state_.pass == 0 || was_upper_)) {
      ++state_.pass;
      was_upper_ = false;
      complete_ = complete_ || state_.pass > plan_.passes;
    }
    state_.direction = direction;
    extreme_ = position;
    state_.station.reset();  // the same station, approached from the other side, is another visit
  }
  if (direction * (position - extreme_) > 0.0) extreme_ = position;
}

void SweepFollower::FollowStation(double position, double time_s) {
  const auto& stations = plan_.stations;
  const auto above = std::lower_bound(stations.begin(), stations.end(), position - plan_.window);
  std::optional<std::size_t> here;
  if (above != stations.end() && *above <= position + plan_.window) {
    here = static_cast<std::size_t>(above - stations.begin());
  }
  if (here != state_.station) {
    state_.station = here;
    arrived_s_ = time_s;
    good_here_ = false;
  }
  state_.settled = here.has_value() && time_s - arrived_s_ >= plan_.settle;
}

void SweepFollower::CountVisit(double time_s, bool good) {
  if (!state_.settled || state_.pass < 1 || state_.pass > plan_.passes) return;
  good_here_ = good_here_ || good;
  const double stood = time_s - arrived_s_ - plan_.settle;
  const std::size_t visit = VisitIndex();
  if (good_here_ && stood >= 0.5 * plan_.dwell && !done_[visit]) {
    done_[visit] = true;
    ++visits_done_;
  }
  if (visit + 1 == visits_.size() && stood >= plan_.dwell) complete_ = true;
}

std::size_t SweepFollower::VisitIndex() const {
  const std::size_t count = plan_.stations.size();
  const std::size_t in_run = state_.direction > 0 ? *state_.station : count - 1 - *state_.station;
  const std::size_t run = 2 * (state_.pass - 1) + (state_.direction > 0 ? 0 : 1);
  return run * count + in_run;
}

std::vector<Visit> SweepFollower::Lacking() const {
  std::vector<Visit> lacking;
  for (std::size_t i = 0; i < visits_.size(); ++i) {
    if (!done_[i]) lacking.push_back(visits_[i]);
  }
  return lacking;
}

}  // namespace abbe::hal
