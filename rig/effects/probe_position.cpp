// The electrode is displaced along u, and along s (top) or n (side).
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect ProbePosition() {
  return {
      .name = "probe-position",
      .objects = kProbeObject,
      .keys = {{"du_mm", Draw::kEvenSigned, 0.02, 0.3}, {"dv_mm", Draw::kEvenSigned, 0.02, 0.3}},
      .in_world =
          [](const HiddenEffect& e, WorldParts& world) {
            ProbeTruth& probe = world.probes[e.place()];
            probe.along += e.At("du_mm");
            probe.across += e.At("dv_mm");
          },
  };
}

}  // namespace abbe::rig::effects
