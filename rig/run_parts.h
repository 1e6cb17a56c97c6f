// What hidden effects do in one recording: between the scales and the tool, to the ball in its cap,
// and to the readings.
//
//   true position of an axis = position by the controller + sum of the shifts of this axis
//
// An effect on a probe adds to the gap of its channel, one on a pivot to the angle of its encoder.
// A data effect replaces the value, noise included. All are called in the order of time, shifts
// once for each state. Constants of the machine are in world_parts.h, those of the linkage in
// linkage_parts.h. Signs: docs/virtual-rig.md. Units: m, s, rad. Failure: none. Validity: the steps
// in time must be short against a reversal of the axes (hidden_run.h).
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "rig/dragged.h"
#include "rig/hidden_effect.h"
#include "rig/machine_state.h"

namespace abbe::rig {

using OfState = std::function<double(const MachineState&)>;
using OfPivot = std::function<double(const MachineState&, double turn)>;  // the true angle
using OfValue = std::function<double(double time, double value)>;

struct RunParts {
  struct AxisShift {
    int axis;
    OfState shift;
  };
  struct ProbeAddition {
    int probe;
    OfState gap;
  };
  struct PivotAddition {
    int pivot;
    OfPivot angle;
    bool has_history = false;  // depends on what the pivot did before
  };
  struct DataEffect {
    bool probe;  // else a pivot
    int index;
    OfValue said;
  };
  std::vector<AxisShift> shifts;
  std::vector<ProbeAddition> probes;
  std::vector<PivotAddition> pivots;
  std::vector<DataEffect> data;
  std::vector<DraggedBall> balls;
  std::vector<std::array<std::size_t, 2>> swapped;  // probes
  std::array<double, 2> late{};                     // s, of the probes and of the linkage

  void Shift(int axis, OfState by) { shifts.push_back({axis, std::move(by)}); }
  void Gap(int probe, OfState by) { probes.push_back({probe, std::move(by)}); }
  void Angle(int pivot, OfPivot by) { pivots.push_back({pivot, std::move(by)}); }
  void AngleWithHistory(int pivot, OfPivot by) { pivots.push_back({pivot, std::move(by), true}); }
  void Said(bool probe, int index, OfValue said) {
    data.push_back({probe, index, std::move(said)});
  }
};

// What several effects have in common.
OfState Lag(int axis, double delay);  // -delay * speed
OfState Wave(double frequency, double amplitude, double phase);
OfState WarmUp(double amplitude, double time_constant);

// The axis that is not in a pair of axes.
int ThirdAxis(const HiddenEffect& effect);
// "x_mm"
std::string PositionColumn(int axis);
// Else of a pivot.
bool IsOfProbe(const HiddenEffect& effect);

}  // namespace abbe::rig
