// More form on the face under one unit of the head; it goes with the target.
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect TargetForm() {
  return {
      .name = "target-form",
      .objects = kFaceObject,
      .keys = {{"rms_um", Draw::kEven, 0.05, 0.5}},
      .in_world = [](const HiddenEffect& e,
                     WorldParts& world) { world.forms[e.place()].push_back(e.At("rms_um")); },
  };
}

}  // namespace abbe::rig::effects
