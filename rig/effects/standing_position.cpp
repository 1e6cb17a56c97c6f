// An axis stands elsewhere in each run, by a normal draw, until it moves.
#include <cmath>
#include <optional>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect StandingPosition() {
  return {
      .name = "standing-position",
      .objects = kAxisObject,
      .keys = {{"rms_um", Draw::kEven, 0.3, 5.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            struct Run {
              double from, offset;
              bool stands = true;
            };
            run.Shift(e.place(),
                      [e, own = std::optional<Run>()](const MachineState& state) mutable {
                        constexpr double kStill = 1e-6;  // m
                        constexpr std::uint64_t kFirstDraw = 1000;
                        const double at = state.position[e.place()];
                        if (!own) {  // recordings begin at whole seconds
                          const auto second = static_cast<std::uint64_t>(std::llround(state.time));
                          own = {at, e.At("rms_um") * e.random.Normal(kFirstDraw + second)};
                        }
                        own->stands = own->stands && std::abs(at - own->from) < kStill;
                        return own->stands ? own->offset : 0.0;
                      });
          },
  };
}

}  // namespace abbe::rig::effects
