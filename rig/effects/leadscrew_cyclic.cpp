// A sine of the position, as a leadscrew makes it once per turn.
#include <cmath>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect LeadscrewCyclic() {
  return {
      .name = "leadscrew-cyclic",
      .objects = kAxisObject,
      .keys = {{"pitch_mm", Draw::kUniform, 4.0, 10.0},
               {"amplitude_um", Draw::kEven, 0.3, 4.0},
               kPhase},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(e.place(),
                      [axis = e.place(), pitch = e.At("pitch_mm"), amplitude = e.At("amplitude_um"),
                       phase = e.At("phase_rad")](const MachineState& state) {
                        return amplitude * std::sin(kTurn * state.position[axis] / pitch + phase);
                      });
          },
  };
}

}  // namespace abbe::rig::effects
