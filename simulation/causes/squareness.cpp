// Squareness: the line of the second axis is turned against the first, machine/volumetric_error.h.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause Squareness() {
  return {
      .id = "squareness",
      .words = {.what = "two axes are not at right angles",
                .shows = "circles become ellipses along the diagonals",
                .check = "guideways and their fastening; whether it came with a collision or a new "
                         "foundation",
                .remedy = "realign the axis or set the angle in the controller"},
      .keys = {{"angle_urad", 1e-6, -10000.0, 10000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 100e-6),
      .objects = AxisPairsOf,
      .relaxes = [](const Object& object) -> std::vector<std::string> {
        if (object == "XY") return {"squareness.C0Y"};
        return {object == "XZ" ? "squareness.B0Z" : "squareness.A0Z"};
      },
      .in_map = true,
  };
}

}  // namespace abbe::simulation
