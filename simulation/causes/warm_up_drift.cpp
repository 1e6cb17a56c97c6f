// Warm-up: amplitude (1 - exp(-t / time constant)), t since the first run began.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<Object> AxesAndProbes(const Scene& scene) {
  std::vector<Object> objects = AxesOf(scene);
  for (Object& probe : ProbesOf(scene)) objects.push_back(std::move(probe));
  return objects;
}

}  // namespace

Cause WarmUpDrift() {
  return {
      .id = "warm-up-drift",
      .words = {.what = "something warms up from the start of the campaign on and creeps towards "
                        "its final state",
                .shows = "passes and runs move away from the first one, fast at first, then slower",
                .check = "spindle, drives, electronics: what was switched on shortly before",
                .remedy = "let it warm up for five times the time constant before measuring"},
      .keys = {{"amplitude_um", 1e-6, -1000.0, 1000.0}, {"time_constant_s", 1.0, 1.0, 1e6}},
      .plausible = Eigen::VectorXd::Constant(1, 3e-6),
      .objects = AxesAndProbes,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        const Eigen::RowVectorXd warm = 1.0 - (-trace.clock.transpose().array() / shape[0]).exp();
        if (object.kind() != Object::Kind::kProbe)
          return {InStage(trace, Positioning(object.first()), warm)};
        if (!trace.head) return {};
        return {InStage(
            trace, kReadingStage + trace.head->row_of[static_cast<std::size_t>(object.first())],
            warm)};
      },
      .shapes = [](const Scene&) { return GeometricShapes(20.0, 20000.0, 1.7); },
      .follows = Follows::kTime,
  };
}

}  // namespace abbe::simulation
