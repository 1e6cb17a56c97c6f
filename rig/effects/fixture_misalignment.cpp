// Turns and shifts the head in its fixture for all axes, before the fitter sets the gaps.
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect FixtureMisalignment() {
  return {
      .name = "fixture-misalignment",
      .objects = kHeadObject,
      .keys = {{"roll_urad", Draw::kEvenSigned, 500.0, 3000.0},
               {"pitch_urad", Draw::kEvenSigned, 500.0, 3000.0},
               {"yaw_urad", Draw::kEvenSigned, 500.0, 3000.0},
               {"du_mm", Draw::kEvenSigned, 0.05, 0.3},
               {"ds_mm", Draw::kEvenSigned, 0.05, 0.3},
               {"dn_mm", Draw::kEvenSigned, 0.05, 0.3}},
      .in_world =
          [](const HiddenEffect& e, WorldParts& world) {
            world.head_angles +=
                Eigen::Vector3d(e.At("roll_urad"), e.At("pitch_urad"), e.At("yaw_urad"));
            world.head_offsets += Eigen::Vector3d(e.At("du_mm"), e.At("ds_mm"), e.At("dn_mm"));
          },
  };
}

}  // namespace abbe::rig::effects
