// Probe tilt response: electrodes that are wider than the machine file says see a tilted face
// nearer by (radius tilt)^2 / (4 gap), probes/electrode.h to second order.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ProbeTiltResponse() {
  constexpr double kUsual = 3e-3;  // m
  return {
      .id = "probe-tilt-response",
      .words = {.what = "the electrodes are wide, so that a tilted face looks nearer",
                .shows = "gaps that are too small where the face is tilted and near; hidden by the "
                         "zeros and the angles of the machine unless tilt or gap change much",
                .check = "diameter of the electrodes and tilt of the target",
                .remedy = "align the target better, or state head.electrode_radius_mm"},
      .keys = {{"electrode_radius_mm", 1e-3, 0.0, 50.0}},
      .plausible = Eigen::VectorXd::Constant(1, kUsual * kUsual),
      .objects = [](const Scene& scene) -> std::vector<Object> {
        if (!scene.HasSweeps()) return {};
        return {"head"};
      },
      .columns = [](const Trace& trace, const Object&,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.HasTilt()) return {};
        Disturbance nearer = NoDisturbance(trace);
        for (Eigen::Index probe = 0; probe < trace.head->tilt.rows(); ++probe) {
          nearer.row(kReadingStage + probe) = -0.25 * trace.head->tilt.row(probe).array().square() /
                                              trace.head->gap.row(probe).array();
        }
        return {nearer};
      },
      .tell = [](const Eigen::VectorXd& square, const Eigen::VectorXd&) -> Eigen::VectorXd {
        return square.cwiseSign().cwiseProduct(square.cwiseAbs().cwiseSqrt());
      },
      .recall = [](const Eigen::VectorXd& values) -> Recalled {
        return {values.cwiseProduct(values.cwiseAbs()), {}};
      },
  };
}

}  // namespace abbe::simulation
