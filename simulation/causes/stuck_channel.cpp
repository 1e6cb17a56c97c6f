// Found before any fit, row by row: diagnosis/invalid_readings.h.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause StuckChannel() {
  return {
      .id = "stuck-channel",
      .words = {.what = "a channel repeats one reading",
                .shows = "one value, to the last bit, while the others change",
                .check = "amplifier, cable and bus of the channel, the timeout of its device",
                .remedy = "mend the channel and measure again; the rows are left out meanwhile"},
      .keys = {{"from_s", 1.0}, {"to_s", 1.0}},
      .plausible = Eigen::VectorXd::Constant(2, 1.0),
      .objects = [](const Scene&) { return std::vector<Object>{}; },
      .one_event = true,
      .follows = Follows::kTime,
  };
}

}  // namespace abbe::simulation
