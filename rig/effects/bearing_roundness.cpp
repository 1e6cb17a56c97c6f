// The bearing lengthens the link after its pivot two and three times per turn.
#include "rig/effects/registry.h"
#include "rig/linkage_parts.h"

namespace abbe::rig::effects {

Effect BearingRoundness() {
  return {
      .name = "bearing-roundness",
      .objects = kPivotObject,
      .keys = {{"sin2_um", Draw::kEvenSigned, 1.0, 10.0},
               {"cos2_um", Draw::kEvenSigned, 1.0, 10.0},
               {"sin3_um", Draw::kEvenSigned, 1.0, 10.0},
               {"cos3_um", Draw::kEvenSigned, 1.0, 10.0}},
      .in_linkage =
          [](const HiddenEffect& e, LinkageParts& linkage) {
            auto& stretch = linkage.pivots[e.place()].stretch;
            stretch.push_back({2, e.At("sin2_um"), e.At("cos2_um")});
            stretch.push_back({3, e.At("sin3_um"), e.At("cos3_um")});
          },
  };
}

}  // namespace abbe::rig::effects
