// Gravity: a joint of an arm gives under each weight that it carries, in proportion to the torque of
// that weight about it in the pose. Where the machine file states masses there is one number for each
// joint, by the torque of all of them. Else neither weights nor compliances are known, and there is
// one number for each weight (relm/weights.h) at each joint.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause JointCompliance() {
  return {
      .id = "joint-compliance",
      .words = {.what = "a joint of an arm gives under the weights that it carries",
                .shows = "the ball sags where a weight stands far out from the joint",
                .check = "stiffness of the gear, the load stated in the controller, balance",
                .remedy =
                    "keep the compliance in the model of the controller, or lighten the load"},
      .keys = {{"own_urad_per_m", 1e-6, -50000.0, 50000.0},
               {"wrist_urad_per_m", 1e-6, -50000.0, 50000.0},
               {"ball_urad_per_m", 1e-6, -50000.0, 50000.0},
               {"torque_urad_per_newton_m", 1e-6, -10000.0, 10000.0}},
      .plausible = Eigen::Vector4d(3e-3, 3e-3, 3e-3, 100e-6),
      .objects = JointsOfArms,
      .relaxes = [](const Object& object) -> std::vector<std::string> {
        const std::string joint = "weight." + object.name();
        return {joint + "_own", joint + "_wrist", joint + "_ball", joint + "_torque"};
      },
  };
}

}  // namespace abbe::simulation
