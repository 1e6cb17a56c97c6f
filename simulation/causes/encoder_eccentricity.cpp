// Encoder eccentricity: sin and cos once per turn of the pivot's own angle.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause EncoderEccentricity() {
  return {
      .id = "encoder-eccentricity",
      .words = {.what = "the graduated disc of an encoder sits off its axis",
                .shows = "an angle error once per turn of the pivot",
                .check = "seat of the disc, run-out of the shaft",
                .remedy = "centre the disc, or keep it as a parameter of the calibration"},
      .keys = {{"sin_urad", 1e-6, -20000.0, 20000.0}, {"cos_urad", 1e-6, -20000.0, 20000.0}},
      .plausible = Eigen::VectorXd::Constant(2, 200e-6),
      .objects = PivotsOf,
      .relaxes = [](const Object& object) -> std::vector<std::string> {
        return {"eccentricity." + object.name() + "_sin_1",
                "eccentricity." + object.name() + "_cos_1"};
      },
      // The parameter is added to the angle that the encoder shows.
      .tell = [](const Eigen::VectorXd& found, const Eigen::VectorXd&) -> Eigen::VectorXd {
        return -found;
      },
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {-values, {}};
      },
  };
}

}  // namespace abbe::simulation
