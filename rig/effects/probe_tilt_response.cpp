// The probes have electrodes of this radius, which read a tilted face as nearer.
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect ProbeTiltResponse() {
  return {
      .name = "probe-tilt-response",
      .objects = kHeadObject,
      .keys = {{"electrode_radius_mm", Draw::kUniform, 1.0, 5.0}},
      .in_world = [](const HiddenEffect& e,
                     WorldParts& world) { world.electrode = e.At("electrode_radius_mm"); },
  };
}

}  // namespace abbe::rig::effects
