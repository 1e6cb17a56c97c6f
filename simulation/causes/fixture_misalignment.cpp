// Fixture misalignment: the head is installed askew, for the sweep of one axis.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause FixtureMisalignment() {
  return {
      .id = "fixture-misalignment",
      .words = {.what = "the head stands askew in the machine",
                .shows = "straightness and angles mix in proportion to the tilt",
                .check = "seat of the fixture against the axis",
                .remedy = "align the fixture, or measure with the head turned by 180 deg"},
      .keys = {{"roll_urad", 1e-6, -50000.0, 50000.0},
               {"pitch_urad", 1e-6, -50000.0, 50000.0},
               {"yaw_urad", 1e-6, -50000.0, 50000.0}},
      .plausible = Eigen::VectorXd::Constant(3, 5e-3),
      .objects =
          [](const Scene& scene) {
            return scene.HasSweeps() ? std::vector<Object>{"head"} : std::vector<Object>{};
          },
      .relaxes = [](const Object&) -> std::vector<std::string> {
        return {"head_turn *.u", "head_turn *.s", "head_turn *.n"};
      },
  };
}

}  // namespace abbe::simulation
