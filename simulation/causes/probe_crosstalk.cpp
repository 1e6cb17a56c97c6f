// Probe crosstalk: the first probe shows coefficient times the Delta of the second in addition.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<Object> PairsOfProbes(const Scene& scene) {
  std::vector<Object> pairs;
  for (const Object& one : ProbesOf(scene)) {
    for (const Object& other : ProbesOf(scene)) {
      if (one != other) pairs.emplace_back(one.name() + "+" + other.name());
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
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.head) return {};
        const int from = object.second();
        return {InStage(trace, kReadingStage + object.first(),
                        trace.head->gap.row(from).array() - trace.head->zero[from])};
      },
  };
}

}  // namespace abbe::simulation
