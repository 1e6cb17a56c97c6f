// Late arrival: the angles were read back before the arm stood, so of the way to the commanded ones
// a share was still to come when the instrument saw the ball.
#include <algorithm>

#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

bool KnowsCommands(const Trace* trace) {
  return trace->linkage && trace->linkage->behind.size() > 0;
}

}  // namespace

Cause LateReading() {
  return {
      .id = "late-reading",
      .words = {.what = "the joints were read back at another moment than the ball was seen",
                .shows = "the ball stands where the joints were sent, not where they were read",
                .check = "whether the arm stands when its joints are read, and the stamps of both",
                .remedy =
                    "read the joints after the arm has settled, or take the commanded angles"},
      .keys = {{"share", 1.0, -2.0, 2.0}},
      .plausible = Eigen::VectorXd::Constant(1, 1.0),
      .objects = [](const Scene& scene) -> std::vector<Object> {
        return std::any_of(scene.traces.begin(), scene.traces.end(), KnowsCommands)
                   ? std::vector<Object>{"arm"}
                   : std::vector<Object>{};
      },
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!KnowsCommands(&trace)) return {};
        Disturbance early = NoDisturbance(trace);
        for (Eigen::Index pivot = 0; pivot < trace.pivots(); ++pivot) {
          early.row(kEncoderStage + pivot) = trace.linkage->behind.row(pivot);
        }
        return {early};
      },
  };
}

}  // namespace abbe::simulation
