// The axis lags by the way that it goes during the delay.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect ServoLag() {
  return {
      .name = "servo-lag",
      .objects = kAxisObject,
      .keys = {{"delay_ms", Draw::kEven, 0.1, 2.0}},
      .in_run = [](const HiddenEffect& e,
                   RunParts& run) { run.Shift(e.place(), Lag(e.place(), e.At("delay_ms"))); },
  };
}

}  // namespace abbe::rig::effects
