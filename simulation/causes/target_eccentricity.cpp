// Eccentricity of a turning shaft: the centre of its rim runs round the axis of rotation.
//
// With the shaft at `shaft` the centre is amplitude away towards phase + shaft, so that the sensor
// at `place` sees  gap = zero - amplitude cos(shaft + phase - place).  Neglected: amplitude^2 /
// (2 radius) twice per turn, 0.4 um where a rim of radius 1 m is off by 0.9 mm.
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"

namespace abbe::simulation {

Cause TargetEccentricity() {
  return {
      .id = "target-eccentricity",
      .words = {.what = "the rim of the shaft or wheel is not centred on its axis of rotation",
                .shows = "once per turn, by the same amount at each sensor, one after the other",
                .check = "run-out by hand with a dial gauge, seat and clamping of the wheel",
                .remedy = "centre it, or take the once per turn out of what is measured"},
      .keys = {{"amplitude_um", 1e-6, 0.0, 10000.0}, {"phase_rad", 1.0, -7.0, 7.0}},
      .plausible = Eigen::VectorXd::Constant(2, 100e-6),
      .objects = ShaftOf,
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.rim) return {};
        const Eigen::RowVectorXd seen = trace.rim->shaft - trace.rim->place;
        return {OnRim(trace, seen.array().sin()), OnRim(trace, -seen.array().cos())};
      },
      // sin(seen) amplitude sin(phase) - cos(seen) amplitude cos(phase)
      .tell = [](const Eigen::VectorXd& found, const Eigen::VectorXd&) -> Eigen::VectorXd {
        return Eigen::Vector2d(found.norm(), std::atan2(found[0], found[1]));
      },
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {values[0] * Eigen::Vector2d(std::sin(values[1]), std::cos(values[1])), {}};
      },
  };
}

}  // namespace abbe::simulation
