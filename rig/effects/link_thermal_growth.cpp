// The link grows more than the machine file says.
#include "rig/effects/registry.h"
#include "rig/linkage_parts.h"

namespace abbe::rig::effects {

Effect LinkThermalGrowth() {
  return {
      .name = "link-thermal-growth",
      .objects = kLinkObject,
      .keys = {{"coefficient_ppm_per_c", Draw::kEvenSigned, 2.0, 20.0}},
      .sensor = true,
      .in_linkage =
          [](const HiddenEffect& e, LinkageParts& linkage) {
            linkage.expansion[e.place()] += e.At("coefficient_ppm_per_c");
          },
  };
}

}  // namespace abbe::rig::effects
