// Hysteresis of a pivot: the encoder shows half of the width too much along the way that the pivot
// last turned.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause JointHysteresis() {
  return {
      .id = "joint-hysteresis",
      .words = {.what = "a pivot or its encoder coupling has play or friction",
                .shows = "angles differ by a constant between the two ways of turning",
                .check = "clamping and coupling of the encoder, friction of the pivot",
                .remedy = "fasten or replace the coupling"},
      .keys = {{"width_urad", 1e-6, -20000.0, 20000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 50e-6),
      .objects = PivotsOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& width) -> std::vector<Disturbance> {
        if (trace.pivots() == 0) return {};
        const int pivot = object.first();
        return {
            InStage(trace, kEncoderStage + pivot, -trace.PivotBacklashLag(pivot, SizeOf(width)))};
      },
      .amount = Amount::kFollowsItsSize,
  };
}

}  // namespace abbe::simulation
