// The progress of a sweep in its plan, from the position of the swept axis alone.
//
// The direction turns when the axis has come back from its farthest point by two windows; overshoot
// of a servo is less. A pass begins where the axis turns forward in the lower half of the sweep
// after it was in the upper half, so jogging in between, or a lost link at the turn itself, costs
// no pass. The axis stands at a station while it is within one window of it. Knows no device, no
// clock and no file.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/sweep_plan.h"

namespace abbe::hal {

struct SweepState {
  int pass = 0;                        // 0: before the first pass
  int direction = 0;                   // +1, -1; 0: it has not moved yet
  std::optional<std::size_t> station;  // where the axis stands
  bool settled = false;                // it has stood there for the plan's `settle`
};

class SweepFollower {
 public:
  explicit SweepFollower(const SweepPlan& plan);

  // The next position of the swept axis (m, absent when it is not known) at `time_s`, and whether
  // all readings taken there are good.
  const SweepState& Step(std::optional<double> position, double time_s, bool good);

  // The last visit has had its dwell, or the machine has begun a pass beyond those of the plan.
  bool complete() const { return complete_; }
  bool moved() const { return state_.direction != 0; }
  double last_motion_s() const { return last_motion_s_; }  // the first step counts as motion

  // A visit is done when the axis stood there, settled, for half of the dwell with at least one
  // good reading: half, because arrival and departure are only seen at the rate of the readings.
  std::size_t visits_done() const { return visits_done_; }
  std::vector<Visit> Lacking() const;

 private:
  void FollowDirection(double position);
  void FollowStation(double position, double time_s);
  void CountVisit(double time_s, bool good);
  std::size_t VisitIndex() const;

  SweepPlan plan_;
  std::vector<Visit> visits_;
  std::vector<bool> done_;
  std::size_t visits_done_ = 0;
  SweepState state_;
  std::uint64_t steps_ = 0;
  bool seen_ = false;  // a position, so far
  bool complete_ = false;
  double extreme_ = 0.0;    // farthest point in the present direction
  bool was_upper_ = false;  // in the upper half since the pass began
  double arrived_s_ = 0.0;  // at the station
  bool good_here_ = false;  // a good reading since it settled
  double rest_ = 0.0;       // position when it last moved by more than a window
  double last_motion_s_ = 0.0;
};

}  // namespace abbe::hal
