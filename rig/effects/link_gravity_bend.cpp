// The pivot gives under the weight of its link: by this angle where the link is level.
#include "rig/effects/registry.h"
#include "rig/linkage_parts.h"

namespace abbe::rig::effects {

Effect LinkGravityBend() {
  return {
      .name = "link-gravity-bend",
      .objects = kPivotObject,
      .keys = {{"compliance_urad", Draw::kEven, 20.0, 300.0}},
      .in_linkage =
          [](const HiddenEffect& e, LinkageParts& linkage) {
            linkage.pivots[e.place()].give += e.At("compliance_urad");
          },
  };
}

}  // namespace abbe::rig::effects
