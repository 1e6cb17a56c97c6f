#include "rig/effects/registry.h"

namespace abbe::rig {

const std::vector<Effect>& EffectCatalogue() {
#define ABBE_CALL_EFFECT(name) effects::name(),
  static const std::vector<Effect> catalogue{ABBE_HIDDEN_EFFECTS(ABBE_CALL_EFFECT)};
#undef ABBE_CALL_EFFECT
  return catalogue;
}

}  // namespace abbe::rig
