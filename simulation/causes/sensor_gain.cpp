// Gain of a gap sensor at a turning shaft, against that of the first, which counts as right: how
// far the shaft really moves is not known otherwise. Only ratios are determined.
#include "simulation/causes/registry.h"
#include "simulation/causes/shaft.h"

namespace abbe::simulation {

namespace {

std::vector<Object> AllButTheFirst(const Scene& scene) {
  std::vector<Object> sensors = RimSensorsOf(scene);
  if (!sensors.empty()) sensors.erase(sensors.begin());
  return sensors;
}

}  // namespace

Cause SensorGain() {
  return {
      .id = "sensor-gain",
      .words = {.what = "a gap sensor shows more or less of the same motion than sensor_1, which "
                        "counts as right: only ratios are determined",
                .shows = "once per turn each sensor has another amplitude, in the right order; "
                         "where all others have the same delta, it is sensor_1 that is off",
                .check = "calibration of the sensors for the material and curvature of the rim",
                .remedy = "calibrate each against gauge steps in place, sensor_1 too: the size of "
                          "all else follows it"},
      .keys = {{"delta", 1.0, -0.9, 9.0}},
      .plausible = Eigen::VectorXd::Constant(1, 0.1),
      .objects = AllButTheFirst,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        const int sensor = object.first();
        if (!trace.rim || sensor >= trace.rim->sensors) return {};
        return {InStage(trace, kReadingStage + sensor, trace.rim->Of(sensor, trace.rim->seen))};
      },
      .always_there = true,
  };
}

}  // namespace abbe::simulation
