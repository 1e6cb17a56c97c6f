// A row shows what this source saw some time before.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect ClockSkew() {
  return {
      .name = "clock-skew",
      .objects = kSourceObject,
      .keys = {{"delay_ms", Draw::kEvenSigned, 0.3, 10.0}},
      .in_run = [](const HiddenEffect& e,
                   RunParts& run) { run.late[e.place()] += e.At("delay_ms"); },
  };
}

}  // namespace abbe::rig::effects
