// Outside the catalogue of causes: an axis follows the square of the feed along the path; the
// height is that at 600 mm/min.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"
#include "settings/unit.h"

namespace abbe::rig::effects {

Effect UnknownFeedSquare() {
  return {
      .name = "unknown-feed-square",
      .objects = kAxisObject,
      .keys = {{"height_um", Draw::kEvenSigned, 2.0, 15.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            const double unit = 600.0 * settings::UnitOf("feed_mm_min").si;
            run.Shift(e.place(), [unit, height = e.At("height_um")](const MachineState& state) {
              return height * state.velocity.squaredNorm() / (unit * unit);
            });
          },
      .variable = [](const HiddenEffect&) -> std::string { return "feed_mm_min"; },
  };
}

}  // namespace abbe::rig::effects
