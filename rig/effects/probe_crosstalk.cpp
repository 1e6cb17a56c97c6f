// The first probe says a share of the d of the second in addition.
#include "rig/effects/registry.h"
#include "rig/world_parts.h"

namespace abbe::rig::effects {

Effect ProbeCrosstalk() {
  return {
      .name = "probe-crosstalk",
      .objects = kProbePairObject,
      .keys = {{"coefficient", Draw::kEvenSigned, 0.002, 0.05}},
      .in_world =
          [](const HiddenEffect& e, WorldParts& world) {
            world.response.of[e.place()][e.places[1]] += e.At("coefficient");
            world.response.any = true;
          },
  };
}

}  // namespace abbe::rig::effects
