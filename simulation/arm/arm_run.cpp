#include "simulation/arm/arm_run.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <memory>

#include "failure/failure.h"
#include "simulation/linkage/linkage_gaps.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

bool IsArm(const recording::Recording& recording) {
  return recording.Kind() == "linkage" && !recording.Find("x_mm") && !recording.Find("y_mm") &&
         !recording.Find("z_mm");
}

namespace {

Matrix3Xd NominalTips(const relm::LinkageSettings& settings, const LinkageRun& run) {
  Matrix3Xd p_BT(3, run.poses());
  for (Index pose = 0; pose < run.poses(); ++pose) {
    p_BT.col(pose) = settings.chain.Tip(Eigen::VectorXd(run.readings.angles.col(pose)));
  }
  return p_BT;
}

// Rms along the principal directions, the largest first.
Vector3d SpreadOf(const Matrix3Xd& places) {
  const Matrix3Xd off = places.colwise() - places.rowwise().mean().eval();
  const Eigen::Matrix3d square = off * off.transpose() / static_cast<double>(places.cols());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(square)
      .eigenvalues()
      .cwiseMax(0.0)
      .cwiseSqrt()
      .reverse();
}

}  // namespace

relm::LinkageSettings Placed(relm::LinkageSettings settings, const LinkageRun& run) {
  const Matrix3Xd p_BT = NominalTips(settings, run);
  const Vector3d spread = SpreadOf(p_BT), down_B = settings.DownB();
  if (spread[0] > kTooNear && spread[1] < kTooNear) {
    throw InputError(fmt::format(
        "{}: its {} poses lie on one line, {:.0f} mm rms along it and {:.0f} mm across: where the "
        "instrument stands cannot be told; record poses that spread",
        run.name, run.poses(), 1e3 * spread[0], 1e3 * spread[1]));
  }
  if (spread[1] > kTooNear) {
    settings.X_MB.R = Eigen::umeyama(p_BT, run.reference, false).topLeftCorner<3, 3>();
  }
  const Vector3d middle = p_BT.rowwise().mean();
  settings.X_MB.p = run.reference.rowwise().mean() - settings.X_MB.R * middle;
  settings.down_M = settings.X_MB.R * down_B;
  settings.tolerance.base_position = kAnywhere;
  settings.tolerance.base_angle = kAnyTurn;
  settings.tolerance.compliance = 0.0;
  settings.tolerance.weight = kLight;
  return settings;
}

relm::LinkageSettings HeldAtOnePlace(relm::LinkageSettings placed, const LinkageRun& run) {
  if (SpreadOf(run.reference)[0] > kTooNear) return placed;
  auto& held = placed.tolerance;
  held.base_angle = held.link = held.ball = held.pivot_angle = held.pivot_offset = 0.0;
  held.encoder_offset = 0.0;
  return placed;
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
  simulated.in_space = [gaps](const Eigen::VectorXd& rows) { return gaps->InSpace(rows); };
  return simulated;
}

}  // namespace abbe::simulation
