// A position, a gap or an angle drifts by less and less from when the machine was switched on.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect WarmUpOfAxis() {
  return {
      .name = "warm-up-drift",
      .objects = kAxisObject,
      .keys = {{"amplitude_um", Draw::kEvenSigned, 1.0, 10.0},
               {"time_constant_s", Draw::kEven, 300.0, 1800.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Shift(e.place(), WarmUp(e.At("amplitude_um"), e.At("time_constant_s")));
          },
  };
}

Effect WarmUpOfProbe() {
  return {
      .name = "warm-up-drift",
      .objects = kProbeObject,
      .keys = {{"amplitude_um", Draw::kEvenSigned, 0.1, 2.0},
               {"time_constant_s", Draw::kEven, 300.0, 1800.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Gap(e.place(), WarmUp(e.At("amplitude_um"), e.At("time_constant_s")));
          },
  };
}

Effect WarmUpOfPivot() {
  return {
      .name = "warm-up-drift",
      .objects = kPivotObject,
      .keys = {{"amplitude_urad", Draw::kEvenSigned, 10.0, 100.0},
               {"time_constant_s", Draw::kEven, 300.0, 1800.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Angle(e.place(), [drift = WarmUp(e.At("amplitude_urad"), e.At("time_constant_s"))](
                                     const MachineState& state, double) { return drift(state); });
          },
  };
}

}  // namespace abbe::rig::effects
