// Outside the catalogue of causes: a probe follows the square of the warmth.
#include <cmath>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect UnknownWarmthSquare() {
  return {
      .name = "unknown-warmth-square",
      .objects = kProbeObject,
      .keys = {{"height_um", Draw::kEvenSigned, 0.2, 2.0}},
      .sensor = true,
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Gap(e.place(),
                    [height = e.At("height_um"), sensor = e.sensor](const MachineState& state) {
                      return height * std::pow(state.warmth.at(sensor), 2);
                    });
          },
      .variable = [](const HiddenEffect& e) -> std::string { return e.sensor; },
  };
}

}  // namespace abbe::rig::effects
