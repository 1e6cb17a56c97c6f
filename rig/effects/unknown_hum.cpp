// Outside the catalogue of causes: a slow line in time in one probe.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect UnknownHum() {
  return {
      .name = "unknown-hum",
      .objects = kProbeObject,
      .keys = {{"amplitude_um", Draw::kEven, 0.1, 1.0},
               {"period_s", Draw::kUniform, 35.0, 45.0},
               kPhase},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Gap(e.place(),
                    Wave(1.0 / e.At("period_s"), e.At("amplitude_um"), e.At("phase_rad")));
          },
      .variable = [](const HiddenEffect&) -> std::string { return "time_s"; },
  };
}

}  // namespace abbe::rig::effects
