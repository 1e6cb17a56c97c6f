// Hidden effects on the readings: probes, encoders, the ball in its cap, data.
//
// An effect on a probe adds to the gap of its channel, one on a pivot to the angle of its encoder.
// A data effect replaces the value, noise included. The static response of the probes (gain,
// nonlinearity, crosstalk, sign) is in world.h, that of the linkage (eccentricity, bearing, bend,
// growth) in linkage.h. Signs: docs/virtual-rig.md.
#pragma once

#include <functional>
#include <vector>

#include "rig/hidden_effect.h"
#include "rig/machine_state.h"

namespace abbe::rig {

struct ProbeAddition {
  int probe;
  std::function<double(const MachineState&)> gap;  // m
};
std::vector<ProbeAddition> ProbeAdditions(const HiddenEffects& hidden);

// To be called in the order of time; `turn` is the true angle of the pivot.
struct PivotAddition {
  int pivot;
  std::function<double(const MachineState&, double turn)> angle;  // rad
  bool remembers = false;  // has hysteresis: depends on the history of the pivot
};
std::vector<PivotAddition> PivotAdditions(const HiddenEffects& hidden);

// To be called for each recorded value, in the order of time.
struct DataEffect {
  bool probe;  // else a pivot
  int index;
  std::function<double(double time, double value)> said;
};
std::vector<DataEffect> DataEffects(const HiddenEffects& hidden);

// The ball trails the cap by `displacement` against the last motion, also at rest: it is dragged
// like a weight on a string.
class DraggedBall {
 public:
  explicit DraggedBall(double displacement) : displacement_(displacement) {}
  // Ball minus cap, m, for a cap at `cap`; zero at the first call.
  Eigen::Vector3d Follow(const Eigen::Vector3d& cap);

 private:
  double displacement_;
  bool begun_ = false;
  Eigen::Vector3d ball_ = Eigen::Vector3d::Zero();
};

}  // namespace abbe::rig
