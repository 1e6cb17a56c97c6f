// The axis grows with the warmth of a sensor since the machine was switched on.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect ThermalGrowth() {
  return {
      .name = "thermal-growth",
      .objects = kAxisObject,
      .keys = {{"coefficient_ppm_per_c", Draw::kEven, 3.0, 20.0}},
      .sensor = true,
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(e.place(), [axis = e.place(), coefficient = e.At("coefficient_ppm_per_c"),
                                  sensor = e.sensor](const MachineState& state) {
              return coefficient * state.warmth.at(sensor) * state.position[axis];
            });
          },
  };
}

}  // namespace abbe::rig::effects
