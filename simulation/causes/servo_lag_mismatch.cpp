// Servo lag mismatch: the second axis of the pair lags more, by delay times its speed; half is
// given to each, so that their mean stays.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ServoLagMismatch() {
  return {
      .id = "servo-lag-mismatch",
      .words = {.what = "two axes follow their commands with different delay",
                .shows =
                    "circles become ellipses along the diagonals that change with sense and feed",
                .check = "gains of the two position loops",
                .remedy = "match the position loop gains"},
      .keys = {{"delay_ms", 1e-3, -1000.0, 1000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 5e-3),
      .objects = AxisPairsOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        const int first = object.first(), second = object.second();
        Disturbance lag = NoDisturbance(trace);
        lag.row(Positioning(first)) = 0.5 * trace.velocity.row(first);
        lag.row(Positioning(second)) = -0.5 * trace.velocity.row(second);
        return {lag};
      },
  };
}

}  // namespace abbe::simulation
