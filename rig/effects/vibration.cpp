// A line in time in the position of an axis, its phase drawn.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect Vibration() {
  return {
      .name = "vibration",
      .objects = kAxisObject,
      .keys = {{"frequency_hz", Draw::kUniform, 3.0, 40.0},
               {"amplitude_um", Draw::kEven, 0.05, 1.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            constexpr std::uint64_t kFreePhase = 1000;  // index of the draw
            run.Shift(e.place(), Wave(e.At("frequency_hz"), e.At("amplitude_um"),
                                      e.random.Uniform(kFreePhase, 0.0, kTurn)));
          },
  };
}

}  // namespace abbe::rig::effects
