// Backlash: the axis lags the command by half of the width, whichever way it last moved.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause Backlash() {
  return {
      .id = "backlash",
      .words = {.what = "the axis loses a fixed distance whenever it turns round: play or wind-up "
                        "in its drive",
                .shows = "forward and backward runs differ by a constant; steps on a circle where "
                         "the axis reverses",
                .check = "play of nut, bearing and coupling; whether the scale or the motor "
                         "encoder closes the loop",
                .remedy = "preload or replace the nut; else set the width in the controller's "
                          "backlash compensation"},
      .keys = {{"width_um", 1e-6, -1000.0, 1000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 10e-6),
      .objects = AxesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& width) -> std::vector<Disturbance> {
        const int axis = object.first();
        return {InStage(trace, Positioning(axis), trace.BacklashLag(axis, SizeOf(width)))};
      },
      .amount = Amount::kFollowsItsSize,
  };
}

}  // namespace abbe::simulation
