// Lobing: the rim of a turning shaft has form, radius = mean + sum of S_n sin(n b) + C_n cos(n b)
// at its own angle b; each sensor sees it when it comes by.
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"

namespace abbe::simulation {

Cause TargetLobing() {
  return {
      .id = "target-lobing",
      .words = {.what = "the rim of the shaft or wheel is not round",
                .shows = "twice to four times per turn, the same form at each sensor, one after "
                         "the other",
                .check = "roundness of the rim, clamping that bends it",
                .remedy = "measure with the form known, or turn the rim true"},
      .keys = {{"sin2_um", 1e-6, -1000.0, 1000.0},
               {"cos2_um", 1e-6, -1000.0, 1000.0},
               {"sin3_um", 1e-6, -1000.0, 1000.0},
               {"cos3_um", 1e-6, -1000.0, 1000.0},
               {"sin4_um", 1e-6, -1000.0, 1000.0},
               {"cos4_um", 1e-6, -1000.0, 1000.0}},
      .plausible = Eigen::VectorXd::Constant(6, 5e-6),
      .objects = ShaftOf,
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.rim) return {};
        const Eigen::RowVectorXd seen = trace.rim->place - trace.rim->shaft;
        std::vector<Disturbance> columns;
        for (const double order : {2.0, 3.0, 4.0}) {
          columns.push_back(OnRim(trace, -(order * seen.array()).sin()));
          columns.push_back(OnRim(trace, -(order * seen.array()).cos()));
        }
        return columns;
      },
  };
}

}  // namespace abbe::simulation
