// A line in time in one probe, at the frequency of the mains.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect MainsPickup() {
  return {
      .name = "mains-pickup",
      .objects = kProbeObject,
      .keys = {{"frequency_hz", Draw::kEither, 50.0, 60.0},
               {"amplitude_um", Draw::kEven, 0.03, 0.5},
               kPhase},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Gap(e.place(), Wave(e.At("frequency_hz"), e.At("amplitude_um"), e.At("phase_rad")));
          },
  };
}

}  // namespace abbe::rig::effects
