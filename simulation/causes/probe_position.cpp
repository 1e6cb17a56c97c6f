// Probe position: the place of a probe in its face is off by du and dv.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ProbePosition() {
  return {
      .id = "probe-position",
      .words = {.what = "a probe does not sit where the machine file says",
                .shows = "straightness and angles mix in proportion to the offset",
                .check = "distances of the probes in the fixture",
                .remedy = "measure the fixture and correct head.probe_* in the machine file"},
      .keys = {{"du_mm", 1e-3, -10.0, 10.0}, {"dv_mm", 1e-3, -10.0, 10.0}},
      .plausible = Eigen::VectorXd::Constant(2, 0.2e-3),
      .objects = ProbesOf,
      .relaxes = [](const Object& object) -> std::vector<std::string> {
        const std::string entry = std::string("probe_position.") + object.name().back();
        return {entry + "_u", entry + (object.first() < 3 ? "_s" : "_n")};
      },
  };
}

}  // namespace abbe::simulation
