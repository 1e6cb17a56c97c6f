// -d.
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect ChannelSign() {
  return {
      .name = "channel-sign",
      .objects = kProbeObject,
      .in_world =
          [](const HiddenEffect& e, WorldParts& world) {
            world.response.inverted[e.place()] = true;
            world.response.any = true;
          },
  };
}

}  // namespace abbe::rig::effects
