// Clock skew at a turning shaft: what the sensors show belongs to where the shaft was `delay`
// before. At one speed it equals a turned eccentricity; a second speed separates them.
// Validity: the shaft keeps its speed in a run.
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"

namespace abbe::simulation {

namespace {

// The angle of the shaft by time: the straight line through all rows. One stamp beside another
// tells the speed badly.
double SpeedOf(const Trace& trace) {
  const Eigen::ArrayXd time = trace.time.array() - trace.time.mean();
  return (time * trace.rim->shaft.transpose().array()).sum() / time.square().sum();
}

}  // namespace

Cause ShaftClockSkew() {
  return {
      .id = "clock-skew",
      .words = {.what = "the readings of the gap sensors are late against the angle of the shaft; "
                        "below 0 the angle is late",
                .shows = "everything at the rim moves on round the shaft in proportion to speed",
                .check = "how the two sources are stamped: filters, cycle times, buffers",
                .remedy = "one trigger for both; else correct the stamps by the delay"},
      .keys = {{"delay_ms", 1e-3, -1000.0, 1000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 20e-3),
      .objects = ShaftOf,
      // What they saw `delay` before, less what they see, over the delay: to its third power.
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd& delay) -> std::vector<Disturbance> {
        if (!trace.rim) return {};
        const double speed = SpeedOf(trace), turned = speed * SizeOf(delay);
        return {
            OnRim(trace, speed * (0.5 * turned * trace.rim->by_angle_twice - trace.rim->by_angle))};
      },
      .amount = Amount::kFollowsItsSize,
  };
}

}  // namespace abbe::simulation
