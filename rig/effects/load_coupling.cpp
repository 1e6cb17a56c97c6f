// The third axis drops with the product of two.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect LoadCoupling() {
  return {
      .name = "load-coupling",
      .objects = kPairObject,
      .keys = {{"coefficient_nm_per_mm2", Draw::kEvenSigned, 0.3, 4.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(ThirdAxis(e), [pair = e.places, coefficient = e.At("coefficient_nm_per_mm2")](
                                        const MachineState& state) {
              return -coefficient * state.position[pair[0]] * state.position[pair[1]];
            });
          },
  };
}

}  // namespace abbe::rig::effects
