// Probe crosstalk: the first probe shows coefficient times the Delta of the second in addition.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<std::string> PairsOfProbes(const Scene& scene) {
  std::vector<std::string> pairs;
  for (const std::string& one : ProbesOf(scene)) {
    for (const std::string& other : ProbesOf(scene)) {
      if (one != other) pairs.push_back(one + "+" + other);
    }
  }
  return pairs;
}

}  // namespace

Cause ProbeCrosstalk() {
  return {
      .id = "probe-crosstalk",
      .words = {.what = "one probe feels the field or the cable of another",
                .shows = "a probe moves when only its neighbour's gap changes",
                .check = "guard rings, grounding, cables side by side, synchronised oscillators",
                .remedy = "separate the cables, ground the target, synchronise the amplifiers"},
      .keys = {{"coefficient", 1.0, -0.9, 0.9}},
      .plausible = Eigen::VectorXd::Constant(1, 0.02),
      .objects = PairsOfProbes,
      .columns = [](const Trace& trace, const std::string& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.head) return {};
        const int from = ProbeOf(object);
        return {InStage(trace, kReadingStage + ProbeOf(object.substr(0, 7)),
                        trace.head->gap.row(from).array() - trace.head->zero[from])};
      },
  };
}

}  // namespace abbe::simulation
