// Thermal growth of a link: its coefficient of expansion is off; the sensor is that of the linkage.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<Object> LinksOf(const Scene& scene) {
  if (scene.Pivots() != 3) return {};
  return {"link_1", "link_2"};
}

}  // namespace

Cause LinkThermalGrowth() {
  return {
      .id = "link-thermal-growth",
      .words = {.what = "a link grows with temperature otherwise than its material says",
                .shows = "the scale of the linkage follows the temperature",
                .check = "material of the link, where the sensor sits",
                .remedy = "measure at one temperature, or calibrate with the recorded one"},
      .keys = {{"coefficient_ppm_per_c", 1e-6, -100.0, 100.0}},
      .plausible = Eigen::VectorXd::Constant(1, 10e-6),
      .objects = LinksOf,
      .relaxes = [](const Object& object) -> std::vector<std::string> {
        return {object.first() == 0 ? "expansion.after_pivot_2" : "expansion.after_pivot_3"};
      },
      .follows = Follows::kTemperature,
  };
}

}  // namespace abbe::simulation
