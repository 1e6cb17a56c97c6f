// Clock skew: the stamps of a source are late against the positions of the axes; what it shows
// belongs to where the axes were `delay` before.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<Object> SourcesOf(const Scene& scene) {
  std::vector<Object> sources;
  if (scene.Pivots() > 0) sources.emplace_back("linkage");
  if (scene.HasSweeps()) sources.emplace_back("probes");
  return sources;
}

}  // namespace

Cause ClockSkew() {
  return {
      .id = "clock-skew",
      .words = {.what = "the clock of an instrument runs behind that of the machine",
                .shows = "readings belong to an earlier position: an offset along the path that "
                         "grows with the feed",
                .check = "how the two sources are synchronised",
                .remedy = "one trigger for both; else correct the stamps by the delay"},
      .keys = {{"delay_ms", 1e-3, -1000.0, 1000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 10e-3),
      .objects = SourcesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd& delay) -> std::vector<Disturbance> {
        if (object == "linkage" ? trace.pivots() == 0 : !trace.head) return {};
        Disturbance late = NoDisturbance(trace);
        for (int axis = 0; axis < 3; ++axis) {
          late.row(Positioning(axis)) =
              0.5 * SizeOf(delay) * trace.acceleration.row(axis) - trace.velocity.row(axis);
        }
        return {late};
      },
      .amount = Amount::kFollowsItsSize,
  };
}

}  // namespace abbe::simulation
