// Adds to C0Y (XY), B0Z (XZ) or A0Z (YZ) of the machine.
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect Squareness() {
  return {
      .name = "squareness",
      .objects = kPairObject,
      .keys = {{"angle_urad", Draw::kEvenSigned, 20.0, 300.0}},
      .in_world =
          [](const HiddenEffect& e, WorldParts& world) {
            const bool xy = e.object == "XY", xz = e.object == "XZ";
            double& angle = xy   ? world.squareness.c0y
                            : xz ? world.squareness.b0z
                                 : world.squareness.a0z;
            angle += e.At("angle_urad");
          },
  };
}

}  // namespace abbe::rig::effects
