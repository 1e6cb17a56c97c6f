#include "simulation/linkage/linkage_gaps.h"

#include <Eigen/Dense>
#include <utility>

#include "simulation/linkage/gap_response.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::VectorXd;

LinkageGaps::LinkageGaps(LinkageSimulation simulation, LinkageRun run, double excess)
    : simulation_(std::move(simulation)),
      run_(std::move(run)),
      noise_(excess * simulation_.GapNoise(run_)) {}

LinkageGaps LinkageGaps::Evenly(const LinkageSimulation& simulation, const LinkageRun& run) {
  LinkageGaps gaps(simulation, run);
  const Index poses = run.poses();
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (Index pose = 0; pose < poses; ++pose) {
    const Eigen::Matrix3d lower = gaps.noise_.middleCols<3>(3 * pose);
    mean += lower * lower.transpose() / static_cast<double>(poses);
  }
  gaps.noise_ = Eigen::Matrix3d(mean.llt().matrixL()).replicate(1, poses);
  return gaps;
}

void LinkageGaps::Evaluate(const VectorXd& x, VectorXd& values,
                           estimation::RowMatrix* jacobian) const {
  Matrix3Xd gap;
  simulation_.Gap(run_, x, gap, jacobian);
  for (Index pose = 0; pose < run_.poses(); ++pose) {
    const auto lower = Noise(pose);
    values.segment<3>(3 * pose) = lower.solve(gap.col(pose));
    if (jacobian != nullptr) lower.solveInPlace(jacobian->middleRows<3>(3 * pose));
  }
}

std::shared_ptr<const Response> LinkageGaps::At(const VectorXd& x) const {
  const Index pivots = run_.readings.angles.rows();
  const Eigen::Matrix3d R_MB = BaseAt(simulation_.settings().X_MB, x.head<6>()).R;
  const VectorXd of_linkage = x.segment(6, simulation_.model().parameters());
  const VectorXd& warmth = run_.readings.warmth;
  Eigen::MatrixXd by_stage = Eigen::MatrixXd::Zero(Rows(), kStages + pivots);
  for (Index pose = 0; pose < run_.poses(); ++pose) {
    const auto tip = simulation_.model().Differentiate(
        run_.readings.angles.col(pose), warmth.size() == 0 ? 0.0 : warmth[pose], of_linkage);
    auto rows = by_stage.middleRows<3>(3 * pose);
    rows.middleCols<3>(kTipStage) = -R_MB;
    rows.rightCols(pivots) = R_MB * tip.J_tip_q;
    Noise(pose).solveInPlace(rows);
  }
  return std::make_shared<GapResponse>(std::move(by_stage), run_.readings.angles);
}

Matrix3Xd LinkageGaps::InSpace(const VectorXd& rows) const {
  Matrix3Xd gaps(3, run_.poses());
  for (Index pose = 0; pose < run_.poses(); ++pose) {
    gaps.col(pose) = Noise(pose) * rows.segment<3>(3 * pose);
  }
  return gaps;
}

}  // namespace abbe::simulation
