// The encoder shows a harmonic of the turn in addition, once per turn.
#include "rig/effects/registry.h"
#include "rig/linkage_parts.h"

namespace abbe::rig::effects {

Effect EncoderEccentricity() {
  return {
      .name = "encoder-eccentricity",
      .objects = kPivotObject,
      .keys = {{"sin_urad", Draw::kEvenSigned, 20.0, 200.0},
               {"cos_urad", Draw::kEvenSigned, 20.0, 200.0}},
      .in_linkage =
          [](const HiddenEffect& e, LinkageParts& linkage) {
            linkage.pivots[e.place()].encoder.push_back({1, e.At("sin_urad"), e.At("cos_urad")});
          },
  };
}

}  // namespace abbe::rig::effects
