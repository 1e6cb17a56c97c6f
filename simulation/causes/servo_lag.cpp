// Servo lag: the axis is where it was sent `delay` ago: -delay times its speed.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ServoLag() {
  return {
      .id = "servo-lag",
      .words =
          {.what = "the axis follows its command late",
           .shows =
               "on a moving path the axis is behind by delay times speed; nothing while it stands",
           .check = "gain of the position loop, feed-forward",
           .remedy = "tune the axis so that all axes lag alike"},
      .keys = {{"delay_ms", 1e-3, -1000.0, 1000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 5e-3),
      .objects = AxesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        const int axis = object.first();
        return {InStage(trace, Positioning(axis), -trace.velocity.row(axis))};
      },
  };
}

}  // namespace abbe::simulation
