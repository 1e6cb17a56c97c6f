// A machine that performs a sweep plan, as pure functions of time: where the swept axis is, and
// what it is doing there. Written from the words of sweep_plan.h, independently of the follower
// under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/sweep_plan.h"

namespace abbe::hal {

class SweptMachine {
 public:
  // Starts at `from` (m) and sets off at `start_s`.
  SweptMachine(const SweepPlan& plan, double from, double start_s) : plan_(plan), time_s_(start_s) {
    knots_.push_back({0.0, from});
    Stay(start_s - 0.0);
    for (int pass = 1; pass <= plan.passes; ++pass) {
      GoTo(plan.first() - plan.overrun);
      Stay(plan.settle);
      for (std::size_t i = 0; i < plan.stations.size(); ++i) StandAt({i, +1, pass});
      GoTo(plan.last() + plan.overrun);
      Stay(plan.settle);
      for (std::size_t i = plan.stations.size(); i-- > 0;) StandAt({i, -1, pass});
    }
  }

  struct Stand {
    Visit visit;
    double from_s, to_s;
  };
  const std::vector<Stand>& stands() const { return stands_; }
  double end_s() const { return knots_.back().time_s; }

  double PositionAt(double time_s) const {
    const auto after =
        std::upper_bound(knots_.begin(), knots_.end(), time_s,
                         [](double time, const Knot& knot) { return time < knot.time_s; });
    if (after == knots_.end()) return knots_.back().position;
    const Knot& b = *after;
    const Knot& a = *(after - 1);
    return a.position + (b.position - a.position) * (time_s - a.time_s) / (b.time_s - a.time_s);
  }

 private:
  struct Knot {
    double time_s, position;
  };
  void GoTo(double position) {
    time_s_ = knots_.back().time_s + std::abs(position - knots_.back().position) / plan_.feed;
    knots_.push_back({time_s_, position});
  }
  void Stay(double seconds) {
    time_s_ = knots_.back().time_s + seconds;
    knots_.push_back({time_s_, knots_.back().position});
  }
  void StandAt(const Visit& visit) {
    GoTo(plan_.stations[visit.station]);
    const double from_s = time_s_;
    Stay(plan_.settle + plan_.dwell + 0.05);
    stands_.push_back({visit, from_s, time_s_});
  }

  SweepPlan plan_;
  double time_s_;
  std::vector<Knot> knots_;
  std::vector<Stand> stands_;
};

inline SweepPlan SmallPlan() {
  SweepPlan plan;
  plan.stations = {0.0, 0.001, 0.003};
  plan.passes = 2;
  plan.idle = 5.0;
  return plan;
}

}  // namespace abbe::hal
