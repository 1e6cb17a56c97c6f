// Encoder count slip: a step of the angle at one instant of the campaign.
#include <algorithm>
#include <limits>

#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

constexpr Eigen::Index kAtMost = 24;  // instants for each run of the linkage

std::vector<Eigen::VectorXd> InstantsTried(const Scene& scene) {
  std::vector<double> instants;
  for (const Trace* trace : scene.traces) {
    if (trace->pivots() == 0) continue;
    const Eigen::Index step = std::max<Eigen::Index>(1, trace->rows() / kAtMost);
    for (Eigen::Index row = 0; row < trace->rows(); row += step) {
      instants.push_back(trace->clock[row]);
    }
  }
  return ShapesOf(instants);
}

// The rows between the instants before and after.
std::vector<Eigen::VectorXd> InstantsNear(const Scene& scene, const Eigen::VectorXd& shape) {
  const std::vector<Eigen::VectorXd> tried = InstantsTried(scene);
  double before = -std::numeric_limits<double>::infinity();
  double after = std::numeric_limits<double>::infinity();
  for (const Eigen::VectorXd& instant : tried) {
    if (instant[0] < shape[0]) before = std::max(before, instant[0]);
    if (instant[0] > shape[0]) after = std::min(after, instant[0]);
  }
  std::vector<double> instants;
  for (const Trace* trace : scene.traces) {
    if (trace->pivots() == 0) continue;
    for (const double clock : trace->clock) {
      if (clock > before && clock < after) instants.push_back(clock);
    }
  }
  return ShapesOf(instants);
}

}  // namespace

Cause EncoderCountSlip() {
  return {
      .id = "encoder-count-slip",
      .words = {.what = "an encoder lost or gained counts at one instant",
                .shows = "a step in one pivot, constant afterwards",
                .check = "cable and connector of the encoder, its supply, speed limits",
                .remedy = "replace the cable; take a new position reference after the instant"},
      .keys = {{"time_s", 1.0, -1e7, 1e7}, {"angle_urad", 1e-6, -1e6, 1e6}},
      .plausible = Eigen::VectorXd::Constant(1, 500e-6),
      .objects = PivotsOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        if (trace.pivots() == 0) return {};
        return {InStage(trace, kEncoderStage + object.first(),
                        (trace.clock.transpose().array() >= shape[0]).cast<double>())};
      },
      .shapes = InstantsTried,
      .nearer = InstantsNear,
      .tell = [](const Eigen::VectorXd& found, const Eigen::VectorXd& shape) -> Eigen::VectorXd {
        return Eigen::Vector2d(shape[0], found[0]);
      },
      .fixed_shapes = true,
      .one_event = true,
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {values.tail(1), values.head(1)};
      },
      .follows = Follows::kTime,
  };
}

}  // namespace abbe::simulation
