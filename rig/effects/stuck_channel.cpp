// The channel repeats its first value of a time.
#include <cmath>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect StuckChannel() {
  return {
      .name = "stuck-channel",
      .objects = kChannelObjects,
      .keys = {kFrom, kTo},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Said(IsOfProbe(e), e.place(),
                     [from = e.At("from_s"), to = e.At("to_s"), held = std::nan("")](
                         double time, double value) mutable {
                       if (!(time >= from && time < to)) return value;
                       if (std::isnan(held)) held = value;
                       return held;
                     });
          },
  };
}

}  // namespace abbe::rig::effects
