#include "simulation/linkage/linkage_simulation.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <string_view>
#include <utility>

#include "failure/failure.h"
#include "geometry/rotation.h"
#include "relm/chain_inverse.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMostSteps = 30;
constexpr double kMet = 1e-14;      // m: below the rounding of a chain of half a metre
constexpr double kReached = 1e-11;  // m: far below any noise
constexpr double kBranch = 0.3;     // rad: a step that keeps to the branch

double WarmthOf(const LinkageRun& run, Index pose) {
  return run.readings.warmth.size() == 0 ? 0.0 : run.readings.warmth[pose];
}

NumericalError OutOfReach(const LinkageRun& run, Index pose, std::string_view why) {
  return NumericalError(fmt::format(
      "{}: row {}: the linkage does not reach ({:.3f}, {:.3f}, {:.3f}) mm of the axes ({}); keep "
      "the poses inside its workspace or move its base",
      run.name, run.rows[pose] + 1, 1e3 * run.reference(0, pose), 1e3 * run.reference(1, pose),
      1e3 * run.reference(2, pose), why));
}

}  // namespace

geometry::Transform<double> BaseAt(const geometry::Transform<double>& nominal_X_MB,
                                   const Vector6& offset) {
  const Vector3d turn = offset.tail<3>();
  return {nominal_X_MB.R * geometry::ExpRotation<double>(turn), nominal_X_MB.p + offset.head<3>()};
}

void JacobianInMachine(const geometry::Transform<double>& nominal_X_MB, const VectorXd& x,
                       const Matrix3Xd& p_BT, const estimation::RowMatrix& J_tip_x,
                       estimation::RowMatrix& J) {
  const Matrix3d R = BaseAt(nominal_X_MB, x.head<6>()).R;
  // exp(w + dw) = exp(w) exp(right dw): the left Jacobian of the way back.
  const Matrix3d right = geometry::ExpRotationJacobian<double>(-x.segment<3>(3));
  J.resize(J_tip_x.rows(), x.size());
  for (Index pose = 0; pose < p_BT.cols(); ++pose) {
    auto rows = J.middleRows<3>(3 * pose);
    const Vector3d p = p_BT.col(pose);
    rows.leftCols<3>() = Matrix3d::Identity();
    rows.middleCols<3>(3) = -R * geometry::Skew(p) * right;
    rows.rightCols(J_tip_x.cols()).noalias() = R * J_tip_x.middleRows<3>(3 * pose);
  }
}

std::string BaseBlock(const std::string& mounting) {
  return mounting.empty() ? "base" : "base " + mounting;
}

std::string BaseTurnBlock(const std::string& mounting) {
  return mounting.empty() ? "base_turn" : "base_turn " + mounting;
}

std::vector<estimation::ParameterBlock> BaseBlocks(const relm::LinkageSettings& settings) {
  return {estimation::ParameterBlock::AroundZero("base", estimation::kMicrometres, {"x", "y", "z"},
                                                 settings.tolerance.base_position),
          estimation::ParameterBlock::AroundZero("base_turn", estimation::kMicroradians,
                                                 {"a", "b", "c"}, settings.tolerance.base_angle)};
}

LinkageSimulation::LinkageSimulation(machine::Chain chain, relm::LinkageSettings settings,
                                     relm::LinkageModel model)
    : chain_(std::move(chain)), settings_(std::move(settings)), model_(std::move(model)) {}

VectorXd LinkageSimulation::Values() const {
  VectorXd x(parameters());
  x << Vector6::Zero(), model_.Values();
  return x;
}

std::vector<estimation::ParameterBlock> LinkageSimulation::Blocks() const {
  std::vector<estimation::ParameterBlock> blocks = BaseBlocks(settings_);
  blocks.insert(blocks.end(), model_.blocks().begin(), model_.blocks().end());
  return blocks;
}

void LinkageSimulation::Check(const VectorXd& x) const {
  if (x.size() == parameters()) return;
  throw InputError(fmt::format("linkage: {} parameters for the {} of the base and model {}",
                               x.size(), parameters(), model_.name()));
}

Matrix3Xd LinkageSimulation::Ball(const LinkageRun& run) const {
  Matrix3Xd p_MT(3, run.poses());
  for (Index pose = 0; pose < run.poses(); ++pose) {
    p_MT.col(pose) = relm::NominalTip(chain_, run.reference.col(pose));
  }
  return p_MT;
}

void LinkageSimulation::Gap(const LinkageRun& run, const VectorXd& x, Matrix3Xd& gap,
                            estimation::RowMatrix* J_gap_x) const {
  Check(x);
  const auto X_MB = BaseAt(settings_.X_MB, x.head<6>());
  estimation::RowMatrix J_tip_x;
  Matrix3Xd p_BT;
  model_.Tips(run.readings, x.tail(model_.parameters()), p_BT,
              J_gap_x == nullptr ? nullptr : &J_tip_x);
  gap = (X_MB.R * p_BT).colwise() + X_MB.p;
  gap -= Ball(run);
  if (J_gap_x != nullptr) JacobianInMachine(settings_.X_MB, x, p_BT, J_tip_x, *J_gap_x);
}

Matrix3Xd LinkageSimulation::GapNoise(const LinkageRun& run) const {
  Matrix3Xd factors(3, 3 * run.poses());
  for (Index pose = 0; pose < run.poses(); ++pose) {
    const Matrix3Xd J_tip_q =
        settings_.X_MB.R * model_.chain().JacobianTipAngles(run.readings.angles.col(pose));
    VectorXd variances(J_tip_q.cols());
    for (Index joint = 0; joint < variances.size(); ++joint) {
      const double encoder = settings_.noise.EncoderOf(joint);
      variances[joint] = encoder * encoder / run.samples[pose];
    }
    Matrix3d covariance = J_tip_q * variances.asDiagonal() * J_tip_q.transpose();
    covariance.diagonal() += run.reference_sd.col(pose).cwiseAbs2();
    const Eigen::LLT<Matrix3d> factor(covariance);
    if (factor.info() != Eigen::Success) {
      throw InputError(fmt::format(
          "{}: row {}: neither the encoders nor the reference have noise; state encoder_urad and "
          "reference_um (machine_um without a reference) in [linkage.noise]",
          run.name, run.rows[pose] + 1));
    }
    factors.middleCols<3>(3 * pose) = factor.matrixL();
  }
  return factors;
}

VectorXd LinkageSimulation::Start(const Vector3d& p_BT, const VectorXd& near) const {
  if (near.size() > 0) return near;
  if (settings_.pivots) return settings_.pivots->Angles(p_BT, settings_.branch);
  const auto branches = relm::ChainInverse(model_.chain()).Branches(p_BT);
  if (branches.empty()) throw NumericalError("linkage: no angles put the ball there");
  return branches.front();
}

double LinkageSimulation::Close(const Vector3d& p_BT, double warmth, const VectorXd& values,
                                VectorXd& q) const {
  double miss = 0.0;
  for (int step = 0; step < kMostSteps; ++step) {
    const auto at = model_.Differentiate(q, warmth, values);
    const Vector3d left = p_BT - at.tip;
    miss = left.norm();
    if (!(miss > kMet)) break;
    VectorXd change = MatrixXd(at.J_tip_q).completeOrthogonalDecomposition().solve(left);
    const double largest = change.cwiseAbs().maxCoeff();
    if (largest > kBranch) change *= kBranch / largest;
    q += change;
  }
  return miss;
}

MatrixXd LinkageSimulation::Readings(const LinkageRun& run, const VectorXd& x,
                                     const VectorXd& near) const {
  Check(x);
  const auto X_BM = BaseAt(settings_.X_MB, x.head<6>()).Inverse();
  const Matrix3Xd p_MT = Ball(run);
  const VectorXd values = x.tail(model_.parameters());
  MatrixXd angles(model_.joints(), run.poses());
  VectorXd q = near;
  for (Index pose = 0; pose < run.poses(); ++pose) {
    const Vector3d p_BT = X_BM * Vector3d(p_MT.col(pose));
    try {
      if (pose == 0 || settings_.pivots) q = Start(p_BT, near);
    } catch (const NumericalError& error) {
      throw OutOfReach(run, pose, error.what());
    }
    const double miss = Close(p_BT, WarmthOf(run, pose), values, q);
    if (!(miss < kReached))
      throw OutOfReach(run, pose, fmt::format("{:.3g} mm are left", 1e3 * miss));
    angles.col(pose) = q;
  }
  return angles;
}

}  // namespace abbe::simulation
