// Mains pick-up: 50 or 60 Hz in a channel, aliased by the pace of the readings.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause MainsPickup() {
  return {
      .id = "mains-pickup",
      .words = {.what = "a channel picks up the mains",
                .shows = "a line at the mains frequency, aliased, in a channel that holds still",
                .check = "grounding and shielding of the cable, switched power supplies nearby",
                .remedy = "ground at one point, average over full mains periods"},
      .keys = {{"frequency_hz", 1.0, 1.0, 1000.0},
               {"amplitude_um", 1e-6, -100.0, 100.0},
               {"phase_rad", 1.0, -7.0, 7.0}},
      .plausible = Eigen::VectorXd::Constant(2, 0.3e-6),
      .objects = ProbesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        if (!trace.head) return {};
        return LineInStage(trace, kReadingStage + object.first(), shape[0], trace.time);
      },
      .shapes =
          [](const Scene&) {
            return ShapesOf({50.0, 60.0});
          },
      .tell = [](const Eigen::VectorXd& found, const Eigen::VectorXd& shape) -> Eigen::VectorXd {
        const Eigen::Vector2d wave = AmplitudeAndPhase(found);
        return Eigen::Vector3d(shape[0], wave[0], wave[1]);
      },
      .fixed_shapes = true,
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {SineAndCosine(values[1], values[2]), values.head(1)};
      },
      .follows = Follows::kTime,
  };
}

}  // namespace abbe::simulation
