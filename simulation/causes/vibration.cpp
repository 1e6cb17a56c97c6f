// Vibration: a line in the position of an axis.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause Vibration() {
  return {
      .id = "vibration",
      .words = {.what = "an axis vibrates at one frequency",
                .shows = "a line in time in all channels that feel this axis, moving or not",
                .check = "pumps, fans and drives that run at this speed, resonance of the position "
                         "loop, the foundation",
                .remedy = "remove or decouple the source, lower the gain of the loop; average over "
                          "full periods while measuring"},
      .keys = {{"frequency_hz", 1.0, 0.1, 10000.0},
               {"amplitude_um", 1e-6, -500.0, 500.0},
               {"phase_rad", 1.0, -7.0, 7.0}},
      .plausible = Eigen::VectorXd::Constant(2, 0.5e-6),
      .objects = AxesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        // Neither says how long it averaged.
        if (!trace.averages_known) return {};
        return LineInStage(trace, Positioning(object.first()), shape[0], trace.clock);
      },
      .shapes =
          [](const Scene&) {
            return ShapesOf({7.3, 17.9});
          },
      .tell = [](const Eigen::VectorXd& found, const Eigen::VectorXd& shape) -> Eigen::VectorXd {
        const Eigen::Vector2d wave = AmplitudeAndPhase(found);
        return Eigen::Vector3d(shape[0], wave[0], wave[1]);
      },
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {SineAndCosine(values[1], values[2]), values.head(1)};
      },
      .follows = Follows::kTime,
      .wave = Wave{.shape = Wave::Shape::kFrequency,
                   .least = 1.0,  // slower is a drift, faster is mains
                   .most = 60.0,
                   .stage = [](const Object& object) { return Positioning(object.first()); },
                   .over = [](const Trace& trace, const Object&) -> Eigen::VectorXd {
                     if (!trace.averages_known) return {};
                     return trace.clock;
                   }},
  };
}

}  // namespace abbe::simulation
