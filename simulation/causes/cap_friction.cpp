// Friction in the tool cap: the ball stays back against the way that the cap last took, at any feed
// and while standing.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause CapFriction() {
  return {
      .id = "cap-friction",
      .words =
          {.what = "the ball is dragged in its magnetic cap",
           .shows =
               "circles shrink or grow alike at every feed, and change sense with the direction",
           .check = "dirt between ball and cap, the force of the magnet",
           .remedy = "clean the cap and the ball; see abbe path --test cap"},
      .keys = {{"displacement_um", 1e-6, -1000.0, 1000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 3e-6),
      .objects =
          [](const Scene& scene) {
            return scene.Pivots() > 0 ? std::vector<Object>{"cap"} : std::vector<Object>{};
          },
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (trace.pivots() == 0) return {};
        Disturbance drag = NoDisturbance(trace);
        for (int k = 0; k < 3; ++k) drag.row(kToolStage + k) = -trace.linkage->cap_direction.row(k);
        return {drag};
      },
  };
}

}  // namespace abbe::simulation
