// Outside the catalogue of causes: an encoder reads more about one angle.
#include <cmath>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect UnknownAngleBump() {
  return {
      .name = "unknown-angle-bump",
      .objects = kPivotObject,
      .keys = {{"height_urad", Draw::kEvenSigned, 15.0, 120.0},
               {"centre_rad", Draw::kTurn},
               {"width_rad", Draw::kUniform, 0.01, 0.03}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            if (std::isnan(e.At("centre_rad"))) return;
            run.Angle(e.place(), [height = e.At("height_urad"), centre = e.At("centre_rad"),
                                  width = e.At("width_rad")](const MachineState&, double turn) {
              const double from = std::remainder(turn - centre, kTurn) / width;
              return height * std::exp(-0.5 * from * from);
            });
          },
      .variable = [](const HiddenEffect& e) -> std::string { return e.object + "_rad"; },
  };
}

}  // namespace abbe::rig::effects
