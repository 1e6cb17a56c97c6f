// Gravity: a pivot of a linkage on a machine gives under the weight of its link, compliance times
// the cosine of the elevation. Of arms: joint_compliance.cpp.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause LinkGravityBend() {
  return {
      .id = "link-gravity-bend",
      .words = {.what = "a link or pivot gives under its own weight",
                .shows = "the ball sags where the link lies flat",
                .check = "preload of the pivot's bearing, balance weight",
                .remedy =
                    "balance the link, or keep the compliance as a parameter of the calibration"},
      .keys = {{"compliance_urad", 1e-6, -20000.0, 20000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 200e-6),
      .objects = [](const Scene& scene) -> std::vector<Object> {
        return scene.HasArms() ? std::vector<Object>{} : PivotsOf(scene);
      },
      .relaxes = [](const Object& object) -> std::vector<std::string> {
        return {std::string("compliance.") + object.name()};
      },
  };
}

}  // namespace abbe::simulation
