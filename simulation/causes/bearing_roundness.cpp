// Bearing roundness: the link after a pivot grows and shrinks twice and three times per turn of the
// pivot, L(q) = L + sum of C sin n q + D cos n q, Boelens (2006).
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause BearingRoundness() {
  return {
      .id = "bearing-roundness",
      .words = {.what = "the bearing of a pivot is not round",
                .shows = "the ball wanders twice or three times per turn of the pivot",
                .check = "preload and seat of the bearing",
                .remedy = "replace the bearing, or calibrate with bearing harmonics"},
      .keys = {{"sin2_um", 1e-6, -1000.0, 1000.0},
               {"cos2_um", 1e-6, -1000.0, 1000.0},
               {"sin3_um", 1e-6, -1000.0, 1000.0},
               {"cos3_um", 1e-6, -1000.0, 1000.0}},
      .plausible = Eigen::VectorXd::Constant(4, 5e-6),
      .objects = PivotsOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (trace.pivots() == 0) return {};
        const int pivot = object.first();
        std::vector<Disturbance> columns;
        for (const double order : {2.0, 3.0}) {
          for (const double quarter : {0.0, 0.5 * std::numbers::pi}) {
            const Eigen::RowVectorXd wave =
                (order * trace.linkage->angles.row(pivot).array() + quarter).sin();
            Disturbance longer = NoDisturbance(trace);
            for (int k = 0; k < 3; ++k) {
              longer.row(kTipStage + k) = trace.linkage->link.row(3 * pivot + k).cwiseProduct(wave);
            }
            columns.push_back(std::move(longer));
          }
        }
        return columns;
      },
  };
}

}  // namespace abbe::simulation
