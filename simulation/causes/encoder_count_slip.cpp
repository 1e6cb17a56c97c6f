// Encoder count slip: a step of the angle at one instant of the campaign. Which instant between two
// readings it was makes no difference: the middle stands for all of them.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

constexpr std::size_t kAtMost = 24;  // instants for each run of the linkage

// When the linkages were read, in order.
std::vector<double> ClocksOf(const Scene& scene) {
  std::vector<double> clocks;
  for (const Trace* trace : scene.traces) {
    if (trace->pivots() > 0) clocks.insert(clocks.end(), trace->clock.begin(), trace->clock.end());
  }
  std::ranges::sort(clocks);
  clocks.erase(std::unique(clocks.begin(), clocks.end()), clocks.end());
  return clocks;
}

std::vector<Eigen::VectorXd> InstantsTried(const Scene& scene) {
  const std::vector<double> clocks = ClocksOf(scene);
  std::vector<double> instants;
  for (const Trace* trace : scene.traces) {
    if (trace->pivots() == 0) continue;
    const auto rows = static_cast<std::size_t>(trace->rows());
    for (std::size_t row = 0; row < rows; row += std::max<std::size_t>(1, rows / kAtMost)) {
      const auto after =
          std::ranges::lower_bound(clocks, trace->clock[static_cast<Eigen::Index>(row)]);
      if (after != clocks.begin()) instants.push_back(0.5 * (*std::prev(after) + *after));
    }
  }
  return ShapesOf(instants);
}

// Between the rows of the instants before and after.
std::vector<Eigen::VectorXd> InstantsNear(const Scene& scene, const Eigen::VectorXd& shape) {
  const std::vector<double> clocks = ClocksOf(scene);
  double before = -std::numeric_limits<double>::infinity();
  double after = std::numeric_limits<double>::infinity();
  for (const Eigen::VectorXd& instant : InstantsTried(scene)) {
    if (instant[0] < shape[0]) before = std::max(before, instant[0]);
    if (instant[0] > shape[0]) after = std::min(after, instant[0]);
  }
  std::vector<double> instants;
  for (std::size_t row = 1; row < clocks.size(); ++row) {
    const double instant = 0.5 * (clocks[row - 1] + clocks[row]);
    if (instant > before && instant < after) instants.push_back(instant);
  }
  return ShapesOf(instants);
}

// Any instant between the two rows is as probable.
double SpreadOfInstant(const Scene& scene, const Eigen::VectorXd& shape) {
  const std::vector<double> clocks = ClocksOf(scene);
  const auto after = std::ranges::upper_bound(clocks, shape[0]);
  if (after == clocks.begin() || after == clocks.end()) return 0.0;
  return (*after - *std::prev(after)) / std::sqrt(12.0);
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
      .shape_spread = SpreadOfInstant,
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
