// Backlash that is not the same along the axis: change t / 2 + bow (t^2 - 1/3) in addition to its
// mean, t from -1 to 1 over the travel. The mean is `backlash`. The shape: the ends of the travel,
// then the sizes around which the columns are taken.
#include <cmath>

#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<Eigen::VectorXd> TravelOf(const Scene& scene, const Object& object) {
  const double first = scene.first[object.first()];
  return {Eigen::Vector4d(first, first + scene.travel[object.first()], 0.0, 0.0)};
}

// The forms of what changes, at t.
double Slope(double t) { return 0.5 * t; }
double Bow(double t) { return t * t - 1.0 / 3.0; }

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
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        const int axis = object.first();
        const auto share = [&](double at) {
          return (2.0 * at - shape[0] - shape[1]) / (shape[1] - shape[0]);
        };
        const auto width = [&](double at) {
          return std::abs(shape[2] * Slope(share(at)) + shape[3] * Bow(share(at)));
        };
        const Eigen::RowVectorXd lag = shape.tail<2>().isZero(0.0) ? trace.BacklashLag(axis, 0.0)
                                                                   : trace.BacklashLag(axis, width);
        const Eigen::RowVectorXd t = trace.axes.row(axis).unaryExpr(share);
        return {InStage(trace, Positioning(axis), t.unaryExpr(&Slope).cwiseProduct(lag)),
                InStage(trace, Positioning(axis), t.unaryExpr(&Bow).cwiseProduct(lag))};
      },
      .shapes_of = TravelOf,
      .amount = Amount::kFollowsItsSize,
      .fixed_shapes = true,
  };
}

}  // namespace abbe::simulation
