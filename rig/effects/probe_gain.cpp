// d (1 + delta); d is the gap at the start of the sweep minus the gap.
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect ProbeGain() {
  return {
      .name = "probe-gain",
      .objects = kProbeObject,
      .keys = {{"delta", Draw::kEvenSigned, 0.002, 0.05}},
      .in_world = [](const HiddenEffect& e,
                     WorldParts& world) { world.probes[e.place()].gain += e.At("delta"); },
  };
}

}  // namespace abbe::rig::effects
