// The axis goes farther than it shows by a share of its position.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect ScaleError() {
  return {
      .name = "scale-error",
      .objects = kAxisObject,
      .keys = {{"gain_ppm", Draw::kEvenSigned, 20.0, 300.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(e.place(),
                      [axis = e.place(), gain = e.At("gain_ppm")](const MachineState& state) {
                        return gain * state.position[axis];
                      });
          },
  };
}

}  // namespace abbe::rig::effects
