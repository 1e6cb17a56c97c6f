// Probe nonlinearity: Delta + q Delta^2 instead of Delta; Delta = zero gap - gap.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ProbeNonlinearity() {
  return {
      .id = "probe-nonlinearity",
      .words = {.what = "the sensitivity of a probe changes over its range",
                .shows = "the error of the probe grows with the square of its gap",
                .check = "linearity certificate of probe and amplifier, stray capacitance",
                .remedy = "linearise the probe against gauge steps, or keep nearer to the middle "
                          "of its range"},
      .keys = {{"quadratic_per_mm", 1e3, -20.0, 20.0}},
      .plausible = Eigen::VectorXd::Constant(1, 200.0),
      .objects = ProbesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.head) return {};
        const Eigen::Index probe = trace.head->row_of[static_cast<std::size_t>(object.first())];
        return {InStage(trace, kReadingStage + probe,
                        -(trace.head->gap.row(probe).array() - trace.head->zero[probe]).square())};
      },
  };
}

}  // namespace abbe::simulation
