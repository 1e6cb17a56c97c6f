// Encoder subdivision: sin and cos `order` times per turn, order 8 and more. Of an encoder it is
// whole; behind the gear of an arm it need not be, and stands for all up to those beside it.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause EncoderSubdivision() {
  return {
      .id = "encoder-subdivision",
      .words = {.what = "the interpolation between the lines of an encoder is uneven",
                .shows = "a fast wave of the pivot's angle",
                .check = "signal amplitudes of the encoder, contamination of the disc",
                .remedy = "clean and adjust the reading head"},
      .keys = {{"order", 1.0, 2.0, 1e5},
               {"sin_urad", 1e-6, -5000.0, 5000.0},
               {"cos_urad", 1e-6, -5000.0, 5000.0}},
      .plausible = Eigen::VectorXd::Constant(2, 10e-6),
      .objects = PivotsOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        if (trace.pivots() == 0) return {};
        const int pivot = object.first();
        return WaveInStage(trace, kEncoderStage + pivot,
                           shape[0] * trace.linkage->angles.row(pivot));
      },
      .shapes =
          [](const Scene&) {
            std::vector<double> orders;
            for (int order = 8; order <= 128; ++order) orders.push_back(order);
            return ShapesOf(orders);
          },
      .shape_spread = [](const Scene& scene, const Eigen::VectorXd&) -> double {
        return scene.HasArms() ? 0.5 : 0.0;  // U95 is 1
      },
      .tell = [](const Eigen::VectorXd& found, const Eigen::VectorXd& shape) -> Eigen::VectorXd {
        return Eigen::Vector3d(shape[0], found[0], found[1]);
      },
      .fixed_shapes = true,
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {values.tail(2), values.head(1)};
      },
      .phase_follows_encoder_zero = true,
      .wave = Wave{.shape = Wave::Shape::kOrder,
                   .least = 8.0,
                   .most = 20000.0,  // lines of a fine disc
                   .stage = [](const Object& object) { return kEncoderStage + object.first(); },
                   .over = [](const Trace& trace, const Object& object) -> Eigen::VectorXd {
                     if (trace.pivots() <= object.first()) return {};
                     return trace.linkage->angles.row(object.first());
                   }},
  };
}

}  // namespace abbe::simulation
