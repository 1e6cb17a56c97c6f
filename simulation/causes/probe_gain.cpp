// Probe gain: reading of Delta / true - 1; Delta counts from the mean gap.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ProbeGain() {
  return {
      .id = "probe-gain",
      .words = {.what = "a probe shows too much or too little of what it sees",
                .shows = "readings of the probe are off in proportion to its gap",
                .check = "calibration of probe and amplifier, the cable's capacitance",
                .remedy = "recalibrate the probe against gauge steps"},
      .keys = {{"delta", 1.0, -0.9, 0.9}},
      .plausible = Eigen::VectorXd::Constant(1, 0.02),
      .objects = ProbesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.head) return {};
        const Eigen::Index probe = trace.head->row_of[static_cast<std::size_t>(object.first())];
        return {InStage(trace, kReadingStage + probe,
                        trace.head->gap.row(probe).array() - trace.head->zero[probe])};
      },
      .tell = [](const Eigen::VectorXd& found, const Eigen::VectorXd&) -> Eigen::VectorXd {
        return (found.array() / (1.0 - found.array())).matrix();  // the column is what was read
      },
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {(values.array() / (1.0 + values.array())).matrix(), {}};
      },
  };
}

}  // namespace abbe::simulation
