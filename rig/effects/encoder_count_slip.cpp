// The encoder shows an angle in addition from one instant on.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect EncoderCountSlip() {
  return {
      .name = "encoder-count-slip",
      .objects = kPivotObject,
      .keys = {{"time_s", Draw::kInstant}, {"angle_urad", Draw::kEvenSigned, 20.0, 200.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Angle(e.place(), [angle = e.At("angle_urad"), time = e.At("time_s")](
                                     const MachineState& state, double) {
              return state.time >= time ? angle : 0.0;
            });
          },
  };
}

}  // namespace abbe::rig::effects
