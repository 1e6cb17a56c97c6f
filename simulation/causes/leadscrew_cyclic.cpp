// Leadscrew, cyclic: amplitude sin(2 pi x / pitch + phase) in the positioning error.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

constexpr double kShortest = 1.5e-3, kLongest = 30e-3;  // m: usual ones, tried one by one
constexpr double kOfAWave = 0.4;  // of a wave over the travel from one pitch tried to the next

std::vector<Eigen::VectorXd> PitchesTried(const Scene& scene) {
  std::vector<double> pitches;
  const double step = kOfAWave / scene.travel.maxCoeff();
  for (double waves = 1.0 / kLongest; waves < 1.0 / kShortest; waves += step) {
    pitches.push_back(1.0 / waves);
  }
  return ShapesOf(pitches);
}

}  // namespace

Cause LeadscrewCyclic() {
  return {
      .id = "leadscrew-cyclic",
      .words =
          {.what = "an error that repeats with each turn of the screw or each pitch of the scale",
           .shows = "a wave of fixed pitch in the positioning error, the same in both directions",
           .check =
               "bearing seat and coupling of the screw, the pitch against the screw's data sheet",
           .remedy =
               "correct the seat; else a compensation table finer than a quarter of the pitch"},
      .keys = {{"pitch_mm", 1e-3, 0.1, 500.0},
               {"amplitude_um", 1e-6, -500.0, 500.0},
               {"phase_rad", 1.0, -7.0, 7.0}},
      .plausible = Eigen::VectorXd::Constant(2, 2e-6),
      .objects = AxesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        const int axis = object.first();
        return WaveInStage(trace, Positioning(axis),
                           2.0 * std::numbers::pi / shape[0] * trace.axes.row(axis));
      },
      .shapes = PitchesTried,
      .tell = [](const Eigen::VectorXd& found, const Eigen::VectorXd& shape) -> Eigen::VectorXd {
        const Eigen::Vector2d wave = AmplitudeAndPhase(found);
        return Eigen::Vector3d(shape[0], wave[0], wave[1]);
      },
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {SineAndCosine(values[1], values[2]), values.head(1)};
      },
      .in_map = true,
      .wave = Wave{.shape = Wave::Shape::kPeriod,
                   .least = 0.2e-3,  // gratings and micrometer screws
                   .most = kLongest,
                   .stage = [](const Object& object) { return Positioning(object.first()); },
                   .over = [](const Trace& trace, const Object& object) -> Eigen::VectorXd {
                     if (trace.axes.cols() != trace.rows()) return {};
                     return trace.axes.row(object.first());
                   }},
  };
}

}  // namespace abbe::simulation
