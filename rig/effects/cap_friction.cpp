// The ball stays behind the cap against its last motion, at any feed and while standing.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect CapFriction() {
  return {
      .name = "cap-friction",
      .objects = kCapObject,
      .keys = {{"displacement_um", Draw::kEven, 0.5, 5.0}},
      .in_run = [](const HiddenEffect& e,
                   RunParts& run) { run.balls.emplace_back(e.At("displacement_um")); },
  };
}

}  // namespace abbe::rig::effects
