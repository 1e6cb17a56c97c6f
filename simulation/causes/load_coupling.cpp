// Load coupling: the third axis drops by a coefficient times the positions of two others (Z by x
// y). The machine is not rigid; none of the 21 errors can do it.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause LoadCoupling() {
  return {
      .id = "load-coupling",
      .words = {.what = "the structure bends with where the load stands",
                .shows = "height changes with the product of two positions",
                .check = "foundation, guideways, weight on the table",
                .remedy =
                    "support the machine better; limit the load; correct with the extended model"},
      .keys = {{"coefficient_nm_per_mm2", 1e-3, -100.0, 100.0}},
      .plausible = Eigen::VectorXd::Constant(1, 2e-3),
      .objects = AxisPairsOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        const int first = object.first(), second = object.second();
        return {InStage(trace, Positioning(3 - first - second),
                        -trace.axes.row(first).cwiseProduct(trace.axes.row(second)))};
      },
  };
}

}  // namespace abbe::simulation
