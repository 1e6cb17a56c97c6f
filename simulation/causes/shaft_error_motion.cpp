// Error motion of a turning shaft: its axis of rotation wanders twice to four times per turn, the
// centre of the rim by (x, y), x towards the zero of the places of the sensors, y a quarter turn
// on. A sensor sees of it what points towards itself. Source: ISO 230-7:2015, radial error motion.
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"

namespace abbe::simulation {

Cause ShaftErrorMotion() {
  std::vector<CauseKey> keys;
  for (const char* key : {"sin2x_um", "cos2x_um", "sin2y_um", "cos2y_um", "sin3x_um", "cos3x_um",
                          "sin3y_um", "cos3y_um", "sin4x_um", "cos4x_um", "sin4y_um", "cos4y_um"}) {
    keys.push_back({key, 1e-6, -1000.0, 1000.0});
  }
  return {
      .id = "shaft-error-motion",
      .words = {.what = "the axis of rotation wanders in its bearing",
                .shows = "twice to four times per turn, at opposite sensors with opposite signs at "
                         "the same moment",
                .check = "preload, roundness and seat of the bearings; does it change with speed?",
                .remedy = "replace or set the bearings, or take it out of what is measured"},
      .keys = keys,
      .plausible = Eigen::VectorXd::Constant(12, 5e-6),
      .objects = ShaftOf,
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.rim) return {};
        std::vector<Disturbance> columns;
        for (const double order : {2.0, 3.0, 4.0}) {
          const Eigen::ArrayXXd phase = order * trace.rim->shaft.array();
          for (const double quarter : {0.0, 0.5 * std::numbers::pi}) {
            const Eigen::ArrayXXd towards = (trace.rim->place.array() - quarter).cos();
            columns.push_back(OnRim(trace, -towards * phase.sin()));
            columns.push_back(OnRim(trace, -towards * phase.cos()));
          }
        }
        return columns;
      },
  };
}

}  // namespace abbe::simulation
