#include "simulation/arm/arm_correction.h"

#include <fmt/format.h>

#include "simulation/arm/arm_run.h"
#include "simulation/correction_steps.h"
#include "simulation/linkage/linkage_correction.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_trace.h"

namespace abbe::simulation {

using Eigen::Index;

Correction CorrectArm(const recording::Recording& recording,
                      const std::vector<ModelledCause>& causes, const Origin& origin,
                      const relm::LinkageSettings& settings) {
  LinkageRun run = ReadLinkageRun(recording, settings);
  if (!recording.Find("time_s")) run.time.setZero();
  run.ball = recording.HeaderText("mounting.ball").value_or("");
  const LinkageSimulation arm = ArmSimulation(Placed(settings, run));
  Trace trace = ArmTraceOf(recording, run, arm);
  const Sums sums = SumsOf(trace, causes, origin);
  const Eigen::MatrixXd by_stage = sums.machine + sums.instrument;
  const Eigen::VectorXd parameters = ParametersMoved(arm.model(), causes);
  const Eigen::VectorXd nominal = arm.model().Values();
  Correction corrected{recording, {}};
  std::vector<Moved> angles, seen;
  for (Index pivot = 0; pivot < trace.pivots(); ++pivot) {
    angles.emplace_back(corrected.recording, fmt::format("pivot_{}_rad", pivot + 1),
                        corrected.changes.angles);
  }
  for (const char* column : {"ref_x_mm", "ref_y_mm", "ref_z_mm"}) {
    seen.emplace_back(corrected.recording, column, corrected.changes.positions);
  }
  for (Index pose = 0; pose < run.poses(); ++pose) {
    const std::size_t row = run.rows[pose] - recording.first_row;
    const double warmth = run.readings.warmth.size() == 0 ? 0.0 : run.readings.warmth[pose];
    const auto tip = arm.model().Differentiate(run.readings.angles.col(pose), warmth, nominal);
    const Eigen::Vector3d moved_B =
        tip.J_tip_x * parameters + by_stage.block<3, 1>(kTipStage, pose);
    const Eigen::Vector3d moved = arm.settings().X_MB.R * moved_B;
    for (Index pivot = 0; pivot < trace.pivots(); ++pivot) {
      angles[pivot].By(row, -by_stage(kEncoderStage + pivot, pose));
    }
    for (Index axis = 0; axis < 3; ++axis) {
      seen[axis].By(row, -moved[axis]);
    }
  }
  return corrected;
}

}  // namespace abbe::simulation
