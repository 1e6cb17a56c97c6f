// The motion of the machine through a programmed sweep: a pure function of time.
//
// The controller commands each leg as a trapezoid of speed (constant acceleration, cruising at the
// feed, constant braking; a triangle where the leg is too short) and then a standstill: `settle` at
// a turn, `settle + dwell + margin` at a station. The axis follows the command like a first-order
// lag: it trails by lag * speed while cruising and closes in exponentially after arrival. Both are
// closed forms, so that times can be evaluated in any order.
//
// The order of the visits, the turns and the passes are those of hal/sweep_plan.h; the program
// begins and ends at `rest`. m, s.
#pragma once

#include <vector>

#include "hal/sweep_plan.h"

namespace abbe::rig {

struct MotionState {
  double command;   // m, of the controller
  double position;  // m, of the axis, as its scale shows it
  int pass;         // from 1; 0 before the first pass and after the last
  int direction;    // +1 or -1: of the approach, also while standing
  int station;      // at which the controller has arrived; -1 on the way and at a turn
  bool done;        // the program has ended
};

struct Dynamics {
  double acceleration;  // m/s^2
  double lag;           // s
  double margin = 0.2;  // s, longer at a station than the plan asks for
};

class SweepMotion {
 public:
  SweepMotion(const hal::SweepPlan& plan, const Dynamics& dynamics, double rest);

  // At a time since the start, s; before it at rest.
  MotionState At(double time) const;
  double duration() const { return end_; }

  // From the arrival of the controller at a station to its departure.
  struct Standstill {
    double start, end;  // s
    hal::Visit visit;
  };
  const std::vector<Standstill>& standstills() const { return standstills_; }

 private:
  // A time of constant acceleration.
  struct Phase {
    double start;     // s
    double command;   // m, at the start
    double speed;     // m/s, at the start
    double rate;      // m/s^2
    double trailing;  // m, command - position at the start
    int pass, direction, station;
  };
  struct Leg {
    int pass, direction;
    int station;  // at the end, or -1
  };

  void Go(double to, double stand, const Leg& leg);
  void Add(double time, double rate, const Leg& leg, int station);
  double Trailing(const Phase& phase, double since) const;

  Dynamics dynamics_;
  double feed_;
  double end_ = 0.0;
  double command_, speed_ = 0.0, trailing_ = 0.0;  // at end_
  std::vector<Phase> phases_;
  std::vector<Standstill> standstills_;
};

}  // namespace abbe::rig
