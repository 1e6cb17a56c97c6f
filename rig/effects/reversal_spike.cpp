// After a reversal the axis hangs on along the old direction, less and less with the way.
#include <cmath>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect ReversalSpike() {
  return {
      .name = "reversal-spike",
      .objects = kAxisObject,
      .keys = {{"height_um", Draw::kEven, 1.0, 8.0}, {"decay_mm", Draw::kEven, 0.3, 3.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(e.place(), [axis = e.place(), height = e.At("height_um"),
                                  decay = e.At("decay_mm")](const MachineState& state) {
              return -state.direction[axis] * height * std::exp(-state.since_turn[axis] / decay);
            });
          },
  };
}

}  // namespace abbe::rig::effects
