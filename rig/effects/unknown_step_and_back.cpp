// Outside the catalogue of causes: a probe reads more for some time.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect UnknownStepAndBack() {
  return {
      .name = "unknown-step-and-back",
      .objects = kProbeObject,
      .keys = {{"height_um", Draw::kEvenSigned, 0.2, 2.0}, kFrom, kTo},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Gap(e.place(), [height = e.At("height_um"), from = e.At("from_s"),
                                to = e.At("to_s")](const MachineState& state) {
              return state.time >= from && state.time < to ? height : 0.0;
            });
          },
      .variable = [](const HiddenEffect&) -> std::string { return "time_s"; },
  };
}

}  // namespace abbe::rig::effects
