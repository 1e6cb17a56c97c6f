// Curved characteristic of a gap sensor at a turning shaft: it shows D + q D^2, D its gap from its
// zero. The eccentricity then appears twice per turn too. A rim
// of radius r does the same at all sensors, with q = -1 / (2 r): 0.0025 per mm at 200 mm.
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"

namespace abbe::simulation {

Cause SensorNonlinearity() {
  return {
      .id = "sensor-nonlinearity",
      .words = {.what = "the characteristic of a gap sensor is curved",
                .shows = "twice per turn at one sensor, in step with its once per turn, growing "
                         "with the square of the eccentricity",
                .check = "is the gap within the linear range of the sensor for this target?",
                .remedy =
                    "linearise it in place, or centre the wheel so that the gap changes less"},
      .keys = {{"quadratic_per_mm", 1e3, -10.0, 10.0}},
      .plausible = Eigen::VectorXd::Constant(1, 50.0),
      .objects = RimSensorsOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        const int sensor = object.first();
        if (!trace.rim || sensor >= trace.rim->sensors) return {};
        return {InStage(trace, kReadingStage + sensor,
                        trace.rim->Of(sensor, trace.rim->seen.cwiseAbs2()))};
      },
  };
}

}  // namespace abbe::simulation
