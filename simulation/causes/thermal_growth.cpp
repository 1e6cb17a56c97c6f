// Thermal growth: coefficient (T - T at start) position in the positioning error.
// The object names the axis and the sensor: "X temp_table_c".
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<Object> AxesWithSensors(const Scene& scene) {
  std::vector<Object> objects;
  for (const Object& axis : AxesOf(scene)) {
    for (const std::string& sensor : scene.Sensors())
      objects.emplace_back(axis.name() + " " + sensor);
  }
  return objects;
}

}  // namespace

Cause ThermalGrowth() {
  return {
      .id = "thermal-growth",
      .words = {.what = "the axis grows with a temperature that was recorded",
                .shows = "the scale of the axis follows the temperature",
                .check =
                    "heat sources near the axis, whether the scale is compensated for temperature",
                .remedy = "warm up before measuring, or compensate with this sensor"},
      .keys = {{"coefficient_ppm_per_c", 1e-6, -100.0, 100.0}},
      .plausible = Eigen::VectorXd::Constant(1, 10e-6),
      .objects = AxesWithSensors,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        const int axis = object.first();
        const auto sensor = std::find(trace.sensors.begin(), trace.sensors.end(), object.sensor());
        if (sensor == trace.sensors.end()) return {};
        const auto row = sensor - trace.sensors.begin();
        return {InStage(trace, Positioning(axis),
                        trace.warming.row(row).cwiseProduct(trace.axes.row(axis)))};
      },
      .follows = Follows::kTemperature,
  };
}

}  // namespace abbe::simulation
