// The axis lags by half of the width, takes it up after a reversal, and stays while standing.
#include "rig/dragged.h"
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect Backlash() {
  return {
      .name = "backlash",
      .objects = kAxisObject,
      .keys = {{"width_um", Draw::kEven, 1.0, 15.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(e.place(), [axis = e.place(), play = Play(e.At("width_um"))](
                                     const MachineState& state) mutable {
              return play.Follow(state.position[axis]) - state.position[axis];
            });
          },
  };
}

}  // namespace abbe::rig::effects
