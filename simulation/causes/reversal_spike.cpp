// Reversal spike: after a reversal the axis hangs back along its old direction, by
// height exp(-way since / decay).
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ReversalSpike() {
  return {
      .id = "reversal-spike",
      .words = {.what = "the axis sticks for a moment when it turns round",
                .shows = "short spikes on a circle at the quadrants",
                .check = "friction of guideways and seals, lubrication",
                .remedy = "lubricate; friction compensation in the controller"},
      .keys = {{"height_um", 1e-6, -1000.0, 1000.0}, {"decay_mm", 1e-3, 0.01, 100.0}},
      .plausible = Eigen::VectorXd::Constant(1, 5e-6),
      .objects = AxesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        const int axis = object.first();
        return {InStage(trace, Positioning(axis),
                        -trace.heading.row(axis).cwiseProduct(
                            (-trace.since_reversal.row(axis) / shape[0]).array().exp().matrix()))};
      },
      .shapes = [](const Scene&) { return GeometricShapes(0.1e-3, 12e-3, 1.6); },
  };
}

}  // namespace abbe::simulation
