// Outside the catalogue of causes: the third axis follows the sum of two.
#include <cmath>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect UnknownDiagonalRipple() {
  return {
      .name = "unknown-diagonal-ripple",
      .objects = kPairObject,
      .keys = {{"amplitude_um", Draw::kEven, 1.0, 8.0},
               {"period_mm", Draw::kUniform, 7.0, 12.0},
               kPhase},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(ThirdAxis(e), [pair = e.places, period = e.At("period_mm"),
                                     amplitude = e.At("amplitude_um"),
                                     phase = e.At("phase_rad")](const MachineState& state) {
              const double sum = state.position[pair[0]] + state.position[pair[1]];
              return amplitude * std::sin(kTurn * sum / period + phase);
            });
          },
      .variable = [](const HiddenEffect& e) -> std::string {
        return PositionColumn(e.places[0]) + "+" + PositionColumn(e.places[1]);
      },
  };
}

}  // namespace abbe::rig::effects
