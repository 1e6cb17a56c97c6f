#include "simulation/ballbar/ballbar_simulation.h"

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "simulation/stage_response.h"
#include "simulation/trace_motion.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kInPlane = 1e-3;  // m: what moves less does not leave the plane of the circle

double LengthPrior(const BallbarRun& run) {
  return run.length_sd > 0.0 ? run.length_sd : estimation::kNoPrior;
}

// With the centre as the last point.
MachinePoints AlsoCentre(const BallbarRun& run) {
  MachinePoints points = run.points;
  points.axes.conservativeResize(Eigen::NoChange, points.axes.cols() + 1);
  points.axes.rightCols<1>() = run.centre;
  points.rows.push_back(points.rows.back());
  return points;
}

class RadiusResponse : public StageResponse {
 public:
  RadiusResponse(MatrixXd by_stage, VectorXd radius, double sd)
      : StageResponse(std::move(by_stage), 1), radius_(std::move(radius)), sd_(sd) {}

  // Radii, m.
  MatrixXd Readings(const VectorXd& left) const override {
    return (radius_ - sd_ * left).transpose();
  }

 private:
  VectorXd radius_;
  double sd_;
};

// x: centre, length, machine.
class RadiusResidual : public Responsive {
 public:
  RadiusResidual(const machine::VolumetricModel& model, const Vector3d& reference,
                 const BallbarRun& run)
      : points_(model, reference, AlsoCentre(run)), radius_(run.radius), sd_(run.sd) {}

  Index Rows() const override { return radius_.size(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    std::vector<Matrix3Xd> J;
    const Matrix3Xd arms = ArmsOf(x, jacobian == nullptr ? nullptr : &J);
    for (Index i = 0; i < Rows(); ++i) {
      const double length = arms.col(i).norm();
      values[i] = (radius_[i] - x[3] - length) / sd_;
      if (jacobian == nullptr) continue;
      const Eigen::RowVector3d along = arms.col(i).transpose() / length;
      jacobian->row(i) << along / sd_, -1.0 / sd_, along * (J.back() - J[i]) / sd_;
    }
  }

  std::shared_ptr<const Response> At(const VectorXd& x) const override {
    const Matrix3Xd arms = ArmsOf(x, nullptr);
    const MatrixXd by_motions = points_.ByMotions(x.tail(points_.parameters()));
    MatrixXd by_stage(Rows(), kToolStage);
    for (Index i = 0; i < Rows(); ++i) {
      by_stage.row(i) =
          arms.col(i).normalized().transpose() * by_motions.middleRows<3>(3 * i) / sd_;
    }
    return std::make_shared<RadiusResponse>(std::move(by_stage), radius_, sd_);
  }

 private:
  // From the centre ball to the tool ball.
  Matrix3Xd ArmsOf(const VectorXd& x, std::vector<Matrix3Xd>* J) const {
    const Matrix3Xd places = points_.Places(x.tail(points_.parameters()), J);
    const Vector3d centre = places.rightCols<1>() + x.head<3>();
    return places.leftCols(Rows()).colwise() - centre;
  }

  PointsOnMachine points_;
  VectorXd radius_;
  double sd_;
};

}  // namespace

SimulatedRun SimulateBallbar(const machine::VolumetricModel& model, const Vector3d& reference,
                             const BallbarRun& run) {
  const std::string& name = run.points.name;
  SimulatedRun simulated{
      name, "ballbar", {}, nullptr, estimation::RobustLoss::Huber(kHuberThreshold)};
  estimation::ParameterBlock centre("ballbar_centre " + name, {"um", 1e-6}, {});
  for (Index axis = 0; axis < 3; ++axis) {
    const auto along = run.points.axes.row(axis);
    const bool is_across = along.maxCoeff() - along.minCoeff() < kInPlane;
    centre.entries.push_back({.name = std::string(1, "xyz"[axis]),
                              .prior_sd = is_across ? kPlacedAcross : kPlacedInPlane});
  }
  simulated.blocks = {std::move(centre),
                      {"ballbar_length " + (run.ballbar.empty() ? name : run.ballbar),
                       {"um", 1e-6},
                       {{.name = "length", .prior_sd = LengthPrior(run)}}}};
  for (auto& block : model.Blocks()) simulated.blocks.push_back(std::move(block));
  const auto residual = std::make_shared<RadiusResidual>(model, reference, run);
  simulated.residual = simulated.response = residual;
  simulated.heading = HeadingsOf(run.points.axes);
  simulated.times = run.time;
  return simulated;
}

}  // namespace abbe::simulation
