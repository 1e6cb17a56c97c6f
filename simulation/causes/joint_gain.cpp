// Gain of a joint: its encoder sits before a gear and shows (1 + gain) times what the joint turned.
// An encoder on the pivot itself has none: a full turn is a full turn. So only the joints of an arm
// have it.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause JointGain() {
  return {
      .id = "joint-gain",
      .words = {.what = "a joint turns by another share of what its encoder shows than is assumed",
                .shows = "an angle error in proportion to the angle of the joint",
                .check = "ratio of the gear, counts per turn, coupling of the next joint to it",
                .remedy = "correct the ratio in the controller"},
      .keys = {{"gain_ppm", 1e-6, -20000.0, 20000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 300e-6),
      .objects = JointsOfArms,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.linkage || !trace.linkage->is_arm) return {};
        const int pivot = object.first();
        return {InStage(trace, kEncoderStage + pivot, trace.linkage->angles.row(pivot))};
      },
  };
}

}  // namespace abbe::simulation
