// Trailing in the tool cap: the ball stays behind the moving cap, the more the faster it goes, and
// comes back while it stands: displacement feed / (feed + the feed of half of it).
#include "settings/unit.h"
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause CapTrailing() {
  constexpr double kFeed = settings::kMillimetrePerMinute;
  return {
      .id = "cap-trailing",
      .words = {.what = "the ball trails behind its magnetic cap while that moves",
                .shows = "circles turn against the motion, less at a slow feed, and not at all "
                         "where the axes stand",
                .check = "lubrication of ball and cap, the force of the magnet",
                .remedy = "clean the cap and the ball, take a stronger magnet, or measure slowly; "
                          "see abbe path --test cap"},
      .keys = {{"displacement_um", 1e-6, -1000.0, 1000.0}, {"feed_mm_min", kFeed, 0.1, 10000.0}},
      .plausible = Eigen::VectorXd::Constant(1, 1e-6),
      .objects =
          [](const Scene& scene) {
            return scene.Pivots() > 0 ? std::vector<Object>{"cap"} : std::vector<Object>{};
          },
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd& shape) -> std::vector<Disturbance> {
        if (!trace.linkage) return {};
        const Eigen::RowVectorXd feed = trace.velocity.colwise().norm();
        Disturbance behind = NoDisturbance(trace);
        for (int k = 0; k < 3; ++k) {
          behind.row(kToolStage + k) = -trace.linkage->cap_direction.row(k).array() * feed.array() /
                                       (feed.array() + shape[0]);
        }
        return {behind};
      },
      .shapes = [](const Scene&) { return GeometricShapes(2.0 * kFeed, 200.0 * kFeed, 2.0); },
  };
}

}  // namespace abbe::simulation
