// The encoder shows a harmonic of the turn in addition, of the order of its lines.
#include "rig/effects/registry.h"
#include "rig/linkage_parts.h"

namespace abbe::rig::effects {

Effect EncoderSubdivision() {
  return {
      .name = "encoder-subdivision",
      .objects = kPivotObject,
      .keys = {{"order", Draw::kWhole, 8.0, 64.0},
               {"sin_urad", Draw::kEvenSigned, 3.0, 40.0},
               {"cos_urad", Draw::kEvenSigned, 3.0, 40.0}},
      .in_linkage =
          [](const HiddenEffect& e, LinkageParts& linkage) {
            linkage.pivots[e.place()].encoder.push_back(
                {static_cast<int>(e.At("order")), e.At("sin_urad"), e.At("cos_urad")});
          },
  };
}

}  // namespace abbe::rig::effects
