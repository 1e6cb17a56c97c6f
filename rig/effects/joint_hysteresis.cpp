// The encoder reads half of the width too much along the motion of the pivot.
#include "rig/dragged.h"
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect JointHysteresis() {
  return {
      .name = "joint-hysteresis",
      .objects = kPivotObject,
      .keys = {{"width_urad", Draw::kEven, 5.0, 60.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.AngleWithHistory(e.place(), [play = Play(e.At("width_urad"))](const MachineState&,
                                                                              double turn) mutable {
              return turn - play.Follow(turn);
            });
          },
  };
}

}  // namespace abbe::rig::effects
