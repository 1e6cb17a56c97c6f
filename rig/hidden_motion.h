// Hidden effects between the scales and the tool: how far a carriage really is from where its scale
// says.
//
//   actual position of an axis = what the controller shows + the sum of the shifts of this axis
//
// Signs (docs/virtual-rig.md has the table): backlash of width w: -w/2 times the direction of
// motion, a play that is taken up after a turn; servo lag: -delay * speed; a mismatch takes half of
// its delay from each of the two axes; a spike: along the old direction; load coupling: the third
// axis drops. Effects that only change constants of the machine (squareness) are in world.h.
#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "rig/hidden_effect.h"
#include "rig/machine_state.h"

namespace abbe::rig {

inline constexpr double kTurn = 2.0 * std::numbers::pi;

// A play that follows a motion by half of its width behind it.
class Play {
 public:
  explicit Play(double width) : half_(0.5 * width) {}
  // Where what is driven stands; where the motion begins they stand together.
  double Follow(double drive);

 private:
  double half_;
  bool begun_ = false;
  double driven_ = 0.0;
};

// To be asked once for each state, in the order of time.
struct AxisShift {
  int axis;
  std::function<double(const MachineState&)> shift;  // m
};

std::vector<AxisShift> AxisShifts(const HiddenEffects& hidden);

}  // namespace abbe::rig
