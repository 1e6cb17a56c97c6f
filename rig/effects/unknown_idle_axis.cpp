// Outside the catalogue of causes: a probe follows an axis that is not swept. Where it is
// swept, that would be a part of the machine's own errors.
#include <cmath>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect UnknownIdleAxis() {
  return {
      .name = "unknown-idle-axis",
      .objects = kProbeObject,
      .keys = {{"axis", Draw::kWhole, 1.0, 3.0},
               {"amplitude_um", Draw::kEven, 0.3, 3.0},
               {"period_mm", Draw::kUniform, 0.15, 0.3}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Gap(e.place(),
                    [axis = static_cast<int>(e.At("axis")) - 1, amplitude = e.At("amplitude_um"),
                     period = e.At("period_mm")](const MachineState& state) {
                      return state.swept == axis
                                 ? 0.0
                                 : amplitude * std::sin(kTurn * state.position[axis] / period);
                    });
          },
      .variable = [](const HiddenEffect& e) -> std::string {
        return PositionColumn(static_cast<int>(e.values.at("axis")) - 1);
      },
  };
}

}  // namespace abbe::rig::effects
