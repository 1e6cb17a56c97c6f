// Hidden effects between the scales and the tool: the deviation of a carriage from its scale.
//
//   true position of an axis = position by the controller + sum of the shifts of this axis
//
// Signs (docs/virtual-rig.md has the table): backlash (lost motion) of width w: -w/2 times the
// direction of motion, taken up after a reversal; servo lag: -delay * speed; a mismatch has half of
// its delay in each of the two axes; a spike: along the old direction; load coupling: the third
// axis drops. Effects that only change constants of the machine (squareness) are in world.h.
#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "rig/hidden_effect.h"
#include "rig/machine_state.h"

namespace abbe::rig {

inline constexpr double kTurn = 2.0 * std::numbers::pi;

// A backlash element: the output follows the input by half of the width behind it.
class Play {
 public:
  explicit Play(double width) : half_(0.5 * width) {}
  // The output for an input; they are equal at the first call.
  double Follow(double drive);

 private:
  double half_;
  bool begun_ = false;
  double driven_ = 0.0;
};

// To be called once for each state, in the order of time.
struct AxisShift {
  int axis;
  std::function<double(const MachineState&)> shift;  // m
};

std::vector<AxisShift> AxisShifts(const HiddenEffects& hidden);

}  // namespace abbe::rig
