// Warm-up of the encoder of a pivot: that of warm_up_drift.cpp, as an angle.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause PivotWarmUp() {
  Cause cause = WarmUpDrift();
  cause.keys[0] = {"amplitude_urad", 1e-6, -10000.0, 10000.0};
  cause.plausible[0] = 20e-6;
  cause.objects = PivotsOf;
  cause.columns = [](const Trace& trace, const Object& object,
                     const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
    if (trace.pivots() == 0) return {};
    return {InStage(trace, kEncoderStage + object.first(),
                    1.0 - (-trace.clock.transpose().array() / shape[0]).exp())};
  };
  return cause;
}

}  // namespace abbe::simulation
