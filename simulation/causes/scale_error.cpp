// Scale error: actual = command (1 + gain).
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ScaleError() {
  return {
      .id = "scale-error",
      .words = {.what =
                    "the scale or screw of the axis is too long or too short by a constant share",
                .shows = "the positioning error grows in proportion to the position",
                .check = "temperature of scale and machine, the scale factor in the controller",
                .remedy = "correct the scale factor or the compensation table"},
      .keys = {{"gain_ppm", 1e-6, -10000.0, 10000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 100e-6),
      .objects = AxesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        const int axis = object.first();
        return {InStage(trace, Positioning(axis), trace.axes.row(axis))};
      },
      .in_map = true,
  };
}

}  // namespace abbe::simulation
