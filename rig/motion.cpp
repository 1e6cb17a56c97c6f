#include "rig/motion.h"

#include <algorithm>
#include <cmath>

namespace abbe::rig {

SweepMotion::SweepMotion(const hal::SweepPlan& plan, const Dynamics& dynamics, double rest)
    : dynamics_(dynamics), feed_(plan.feed), command_(rest) {
  const double low = plan.first() - plan.overrun, high = plan.last() + plan.overrun;
  const double stand = plan.settle + plan.dwell + dynamics.margin;
  Go(low, plan.settle, {0, low < rest ? -1 : +1, -1});
  hal::Visit last{0, -1, 1};
  for (const hal::Visit& visit : plan.Visits()) {
    // Where the direction changes, the axis reverses beyond the end of the stations.
    if (visit.direction > 0 && last.direction < 0 && visit.pass > 1) {
      Go(low, plan.settle, {last.pass, -1, -1});
    } else if (visit.direction < 0 && last.direction > 0) {
      Go(high, plan.settle, {last.pass, +1, -1});
    }
    Go(plan.stations[visit.station], stand,
       {visit.pass, visit.direction, static_cast<int>(visit.station)});
    standstills_.push_back({end_ - stand, end_, visit});
    last = visit;
  }
  Go(rest, plan.settle, {0, rest < command_ ? -1 : +1, -1});
}

void SweepMotion::Go(double to, double stand, const Leg& leg) {
  const double way = to - command_;
  const double distance = std::abs(way);
  if (distance > 0.0) {
    const double speed = std::min(feed_, std::sqrt(dynamics_.acceleration * distance));
    const double ramp = speed / dynamics_.acceleration;
    const double rate = std::copysign(dynamics_.acceleration, way);
    const double cruise = std::max(0.0, (distance - speed * ramp) / speed);
    Add(ramp, rate, leg, -1);
    Add(cruise, 0.0, leg, -1);
    Add(ramp, -rate, leg, -1);
  }
  // The sums have rounded; the controller stands exactly where it was sent.
  command_ = to;
  speed_ = 0.0;
  Add(stand, 0.0, leg, leg.station);
}

void SweepMotion::Add(double time, double rate, const Leg& leg, int station) {
  const Phase phase{end_, command_, speed_, rate, trailing_, leg.pass, leg.direction, station};
  trailing_ = Trailing(phase, time);
  command_ += speed_ * time + 0.5 * rate * time * time;
  speed_ += rate * time;
  end_ += time;
  phases_.push_back(phase);
}

// With u the command and y the position, y' = (u - y) / lag: the distance e = u - y follows
// e' = u' - e / lag, hence e = lag u' - lag^2 u'' + c exp(-t / lag).
double SweepMotion::Trailing(const Phase& phase, double since) const {
  const double lag = dynamics_.lag;
  const double held = lag * phase.speed - lag * lag * phase.rate;
  return held + lag * phase.rate * since + (phase.trailing - held) * std::exp(-since / lag);
}

MotionState SweepMotion::At(double time) const {
  const auto after = std::upper_bound(phases_.begin(), phases_.end(), time,
                                      [](double t, const Phase& phase) { return t < phase.start; });
  const Phase& phase = after == phases_.begin() ? phases_.front() : *std::prev(after);
  const double since = std::max(0.0, time - phase.start);
  const double command = phase.command + phase.speed * since + 0.5 * phase.rate * since * since;
  return {command,     command - Trailing(phase, since), phase.pass, phase.direction, phase.station,
          time >= end_};
}

}  // namespace abbe::rig
