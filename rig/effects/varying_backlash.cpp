// The axis lags by half of a width that goes with its position: change t / 2 + bow (t^2 - 1/3),
// t from -1 to 1 between two positions. Below 0 it makes a backlash beside it smaller.
#include <cmath>

#include "rig/dragged.h"
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect VaryingBacklash() {
  return {
      .name = "varying-backlash",
      .objects = kAxisObject,
      .keys = {{"change_um", Draw::kEvenSigned, 2.0, 10.0},
               {"bow_um", Draw::kEvenSigned, 1.0, 5.0},
               {"from_mm", Draw::kUniform, 0.0, 0.0},
               {"to_mm", Draw::kUniform, 60.0, 60.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(e.place(), [axis = e.place(), change = e.At("change_um"),
                                  bow = e.At("bow_um"), from = e.At("from_mm"), to = e.At("to_mm"),
                                  play = Play(0.0)](const MachineState& state) mutable {
              const double at = state.position[axis];
              const double share = (at - from) / (to - from);
              const double width =
                  change * (share - 0.5) + bow * (4.0 * (share - 0.5) * (share - 0.5) - 1.0 / 3.0);
              play.Widen(std::abs(width));
              return std::copysign(1.0, width) * (play.Follow(at) - at);
            });
          },
  };
}

}  // namespace abbe::rig::effects
