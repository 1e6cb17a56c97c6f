// Hidden effects in what the instruments say: probes, encoders, the ball in its cap, data.
//
// An effect of a probe adds to the gap that the channel says; one of a pivot to the angle that its
// encoder shows. A data effect replaces what was said, noise and all. The static response of the
// probes (gain, nonlinearity, crosstalk, sign) is in world.h, that of the linkage (eccentricity,
// bearing, bend, growth) in linkage.h. Signs: docs/virtual-rig.md.
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

// To be asked in the order of time; `turn` is what the pivot really turned.
struct PivotAddition {
  int pivot;
  std::function<double(const MachineState&, double turn)> angle;  // rad
  bool remembers = false;  // what it says depends on how the pivot came there
};
std::vector<PivotAddition> PivotAdditions(const HiddenEffects& hidden);

// To be asked for each value that is recorded, in the order of time.
struct DataEffect {
  bool probe;  // else a pivot
  int index;
  std::function<double(double time, double value)> said;
};
std::vector<DataEffect> DataEffects(const HiddenEffects& hidden);

// The ball stays behind the cap by `displacement` against the last motion, also while it stands: it
// is dragged like a weight by a string.
class DraggedBall {
 public:
  explicit DraggedBall(double displacement) : displacement_(displacement) {}
  // Ball minus cap, m, for a cap at `cap`; together where the motion begins.
  Eigen::Vector3d Follow(const Eigen::Vector3d& cap);

 private:
  double displacement_;
  bool begun_ = false;
  Eigen::Vector3d ball_ = Eigen::Vector3d::Zero();
};

}  // namespace abbe::rig
