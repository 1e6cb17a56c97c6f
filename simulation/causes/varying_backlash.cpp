// Backlash that is not the same along the axis: change t / 2 + bow (t^2 - 1/3) in addition to its
// mean, t from -1 to 1 over the travel. The mean is `backlash`.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<Eigen::VectorXd> TravelOf(const Scene& scene, const Object& object) {
  const double first = scene.first[object.first()];
  return {Eigen::Vector2d(first, first + scene.travel[object.first()])};
}

}  // namespace

Cause VaryingBacklash() {
  return {
      .id = "varying-backlash",
      .words = {.what = "the backlash of the axis is larger at one end or in the middle of its "
                        "travel",
                .shows = "forward and backward runs differ by an amount that goes with the "
                         "position",
                .check = "wear of screw and nut where the axis works most, alignment of nut and "
                         "bearings, preload over the travel",
                .remedy = "replace or realign the screw; else compensate positions of both "
                          "directions by tables of their own"},
      .keys = {{"change_um", 1e-6, -1000.0, 1000.0},
               {"bow_um", 1e-6, -1000.0, 1000.0},
               {"from_mm", 1e-3, -100000.0, 100000.0},
               {"to_mm", 1e-3, -100000.0, 100000.0}},
      .plausible = Eigen::VectorXd::Constant(2, 5e-6),
      .objects = AxesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& ends) -> std::vector<Disturbance> {
        const int axis = object.first();
        const Eigen::ArrayXXd t =
            (2.0 * trace.axes.row(axis).array() - ends[0] - ends[1]) / (ends[1] - ends[0]);
        const Eigen::ArrayXXd lag = trace.BacklashLag(axis, 0.0).array();
        return {InStage(trace, Positioning(axis), (0.5 * t * lag).matrix()),
                InStage(trace, Positioning(axis), ((t.square() - 1.0 / 3.0) * lag).matrix())};
      },
      .shapes_of = TravelOf,
      .fixed_shapes = true,
  };
}

}  // namespace abbe::simulation
