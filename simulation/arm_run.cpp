#include "simulation/arm_run.h"

#include <Eigen/Dense>
#include <cmath>
#include <memory>

#include "simulation/linkage_gaps.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

bool IsArm(const recording::Recording& recording) {
  return recording.Kind() == "linkage" && !recording.Find("x_mm") && !recording.Find("y_mm") &&
         !recording.Find("z_mm");
}

relm::LinkageSettings Placed(relm::LinkageSettings settings, const LinkageRun& run) {
  Matrix3Xd p_BT(3, run.poses());
  for (Index pose = 0; pose < run.poses(); ++pose) {
    p_BT.col(pose) = settings.chain.Tip(Eigen::VectorXd(run.readings.angles.col(pose)));
  }
  const Vector3d middle = p_BT.rowwise().mean();
  const Matrix3Xd spread = p_BT.colwise() - middle;
  const Vector3d down_B = settings.DownB();
  // Two directions at least, or the turn about the line of poses is open.
  settings.tolerance.base_position = kAnywhere;
  settings.tolerance.base_angle = kAnyTurn;
  const double across = Eigen::JacobiSVD<Eigen::MatrixXd>(spread).singularValues()[1];
  if (across > kTooNear * std::sqrt(static_cast<double>(run.poses()))) {
    settings.X_MB.R = Eigen::umeyama(p_BT, run.reference, false).topLeftCorner<3, 3>();
  } else {
    auto& held = settings.tolerance;
    held.base_angle = held.link = held.ball = held.pivot_angle = held.pivot_offset = 0.0;
    held.encoder_offset = 0.0;
  }
  settings.X_MB.p = run.reference.rowwise().mean() - settings.X_MB.R * middle;
  settings.down_M = settings.X_MB.R * down_B;
  return settings;
}

LinkageSimulation ArmSimulation(const relm::LinkageSettings& placed) {
  // The axes of this chain stand where the instrument says.
  return {machine::Chain::Parse("[w b X Y Z t]"), placed,
          relm::MakeLinkageModel(placed, relm::ErrorModel::kComplete)};
}

SimulatedRun SimulateArm(const LinkageSimulation& arm, const LinkageRun& run,
                         const Eigen::VectorXd& x, double excess) {
  SimulatedRun simulated{run.name, "linkage", arm.Blocks(), nullptr};
  simulated.blocks[0].name = BaseBlock(run.mounting);
  simulated.blocks[1].name = BaseTurnBlock(run.mounting);
  Index next = 0;
  for (auto& block : simulated.blocks) {
    for (auto& entry : block.entries) entry.value = x[next++];
  }
  const auto gaps = std::make_shared<LinkageGaps>(arm, run, excess);
  simulated.residual = simulated.response = gaps;
  return simulated;
}

}  // namespace abbe::simulation
