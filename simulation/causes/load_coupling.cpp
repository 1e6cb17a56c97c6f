// Load coupling: Z drops by coefficient x y. The machine is not rigid; none of the 21 errors can do
// it.
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
      .plausible = Eigen::VectorXd::Constant(1, 0.5e-3),
      .objects = [](const Scene&) { return std::vector<std::string>{"XY"}; },
      .columns = [](const Trace& trace, const std::string&,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        return {InStage(trace, Positioning(2), -trace.axes.row(0).cwiseProduct(trace.axes.row(1)))};
      },
  };
}

}  // namespace abbe::simulation
