// Outside the catalogue of causes: an encoder wanders at random.
#include "rig/effects/registry.h"
#include "rig/noise.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect UnknownWander() {
  return {
      .name = "unknown-wander",
      .objects = kPivotObject,
      .keys = {{"deviation_urad", Draw::kEven, 10.0, 80.0},
               {"time_constant_s", Draw::kEven, 60.0, 600.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Angle(
                e.place(),
                [drift = SlowDrift(e.random, e.At("deviation_urad"), e.At("time_constant_s"))](
                    const MachineState& state, double) mutable { return drift.At(state.time); });
          },
      .variable = [](const HiddenEffect&) -> std::string { return "time_s"; },
  };
}

}  // namespace abbe::rig::effects
