// d + q d^2.
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect ProbeNonlinearity() {
  return {
      .name = "probe-nonlinearity",
      .objects = kProbeObject,
      .keys = {{"quadratic_per_mm", Draw::kEvenSigned, 0.1, 2.0}},
      .in_world =
          [](const HiddenEffect& e, WorldParts& world) {
            world.response.quadratic[e.place()] += e.At("quadratic_per_mm");
            world.response.any = true;
          },
  };
}

}  // namespace abbe::rig::effects
