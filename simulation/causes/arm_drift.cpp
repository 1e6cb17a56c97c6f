// Drift of an arm and what it stands on before its instrument: (1 - exp(-t / time constant)) along
// x, y and z of its base, t since the first run began.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ArmDrift() {
  return {
      .id = "arm-drift",
      .words = {.what =
                    "the arm, its stand or the instrument warms up and creeps towards its final "
                    "state",
                .shows = "the ball moves away from where the first poses had it, fast at first",
                .check = "drives of the arm and what they warm; targets on the floor show whether "
                         "the instrument moves",
                .remedy = "let the arm move for five times the time constant before measuring"},
      .keys = {{"x_um", 1e-6, -10000.0, 10000.0},
               {"y_um", 1e-6, -10000.0, 10000.0},
               {"z_um", 1e-6, -10000.0, 10000.0},
               {"time_constant_s", 1.0, 1.0, 1e6}},
      .plausible = Eigen::VectorXd::Constant(3, 100e-6),
      .objects = ArmOf,
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        if (!trace.linkage || !trace.linkage->is_arm) return {};
        const Eigen::RowVectorXd warm = 1.0 - (-trace.clock.transpose().array() / shape[0]).exp();
        return {InStage(trace, kTipStage, warm), InStage(trace, kTipStage + 1, warm),
                InStage(trace, kTipStage + 2, warm)};
      },
      .shapes = [](const Scene&) { return GeometricShapes(20.0, 20000.0, 1.7); },
      .follows = Follows::kTime,
  };
}

}  // namespace abbe::simulation
