// Found before any fit, row by row: diagnosis/invalid_readings.h.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause Outliers() {
  return {
      .id = "outliers",
      .words = {.what = "single readings of a channel jump",
                .shows = "readings that stand far from their neighbours",
                .check = "shielding, connectors, bus errors",
                .remedy = "mend the channel; the readings are left out meanwhile"},
      .keys = {{"count", 1.0}},
      .plausible = Eigen::VectorXd::Constant(1, 1.0),
      .objects = [](const Scene&) { return std::vector<Object>{}; },
      .one_event = true,
      .follows = Follows::kTime,
  };
}

}  // namespace abbe::simulation
