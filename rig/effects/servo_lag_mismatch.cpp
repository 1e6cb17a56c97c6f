// Half of the delay in each of the two axes: the first runs ahead, the second lags.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect ServoLagMismatch() {
  return {
      .name = "servo-lag-mismatch",
      .objects = kPairObject,
      .keys = {{"delay_ms", Draw::kEvenSigned, 0.1, 2.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(e.places[0], Lag(e.places[0], -0.5 * e.At("delay_ms")));
            run.Shift(e.places[1], Lag(e.places[1], 0.5 * e.At("delay_ms")));
          },
  };
}

}  // namespace abbe::rig::effects
