// Standing position: until it moves in a run an axis stands at another place in each run, by a random
// offset: on either side of its play, or as it was clamped. How a swept axis came to its places is
// known.
#include <algorithm>
#include <cmath>

#include "simulation/causes/registry.h"
#include "simulation/trace_motion.h"

namespace abbe::simulation {

namespace {

using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr Index kStandingRuns = 80;    // beyond those nothing is known of it
constexpr double kUsualOffset = 1e-6;  // m

// [deviation of an offset, that stated], then the runs.
VectorXd StandingRunsOf(const Scene& scene) {
  VectorXd shape = VectorXd::Constant(2 + kStandingRuns, -1.0);
  shape.head<2>() << kUsualOffset, 0.0;
  Index at = 2;
  for (const Trace* trace : scene.traces) {
    if (at < shape.size()) shape[at++] = trace->identity();
  }
  return shape;
}

// Those until it moves.
Index RowsThatStand(const Trace& trace, int axis) {
  if (trace.axes.cols() != trace.rows() || trace.axis == "XYZ"[axis]) return 0;
  const RowVectorXd position = trace.axes.row(axis);
  Index rows = 0;
  while (rows < position.size() && std::abs(position[rows] - position[0]) < kAxisBand) ++rows;
  return rows;
}

}  // namespace

Cause StandingPosition() {
  return {
      .id = "standing-position",
      .words = {.what = "until it moves, an axis stands elsewhere in each run, though its scale "
                        "shows the same",
                .shows = "circles and sweeps lie apart along the axis that does not move in them",
                .check = "play of the axis, from which side it came to its place, its clamp",
                .remedy = "approach the place of an axis that will stand from the same side before "
                          "each run; preload or replace the nut"},
      .keys = {{"rms_um", 1e-6, 0.0, 1000.0}},
      .plausible = VectorXd::Ones(kStandingRuns),
      .objects = AxesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const VectorXd& shape) -> std::vector<Disturbance> {
        const int axis = object.first();
        const Index rows = RowsThatStand(trace, axis);
        if (rows == 0) return {};
        const auto runs = shape.tail<kStandingRuns>();
        const auto own = std::find(runs.begin(), runs.end(), trace.identity());
        if (own == runs.end()) return {};
        std::vector<Disturbance> columns(kStandingRuns, NoDisturbance(trace));
        columns[own - runs.begin()].row(Positioning(axis)).head(rows).setOnes();
        return columns;
      },
      .shapes = [](const Scene& scene) -> std::vector<VectorXd> { return {StandingRunsOf(scene)}; },
      .tell = [](const VectorXd&, const VectorXd& shape) -> VectorXd { return shape.head(1); },
      .amount = Amount::kRandomField,
      .fixed_shapes = true,
      .own_in_each_run = true,
      .recall = [](const VectorXd& values) -> Recalled {
        return {VectorXd::Zero(kStandingRuns), Eigen::Vector2d(values[0], 0.0)};
      },
  };
}

}  // namespace abbe::simulation
