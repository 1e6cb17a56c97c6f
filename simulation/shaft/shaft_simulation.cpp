#include "simulation/shaft/shaft_simulation.h"

#include <fmt/format.h>

#include <utility>

#include "failure/failure.h"
#include "simulation/stage_response.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

class RimResponse : public StageResponse {
 public:
  RimResponse(MatrixXd by_stage, RowVectorXd gap, RowVectorXd sd)
      : StageResponse(std::move(by_stage), 1), gap_(std::move(gap)), sd_(std::move(sd)) {}

  MatrixXd Readings(const VectorXd& left) const override {
    return gap_ - left.transpose().cwiseProduct(sd_);
  }

 private:
  RowVectorXd gap_, sd_;
};

// x: the zeros.
class RimResidual : public Responsive {
 public:
  explicit RimResidual(const ShaftRun& run) : rim_(run.rim), sd_(run.rows()) {
    for (Index row = 0; row < sd_.size(); ++row) sd_[row] = run.sd[SensorOf(row)];
  }

  Index Rows() const override { return sd_.size(); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    if (jacobian != nullptr) jacobian->setZero();
    for (Index row = 0; row < Rows(); ++row) {
      values[row] = (rim_.gap[row] - x[SensorOf(row)]) / sd_[row];
      if (jacobian != nullptr) (*jacobian)(row, SensorOf(row)) = -1.0 / sd_[row];
    }
  }

  std::shared_ptr<const Response> At(const VectorXd&) const override {
    MatrixXd by_stage = MatrixXd::Zero(Rows(), kReadingStage + rim_.sensors);
    for (Index row = 0; row < Rows(); ++row) {
      by_stage(row, kReadingStage + SensorOf(row)) = 1.0 / sd_[row];
    }
    return std::make_shared<RimResponse>(std::move(by_stage), rim_.gap, sd_);
  }

 private:
  Index SensorOf(Index row) const { return rim_.sensor[row]; }

  RimReadings rim_;
  RowVectorXd sd_;
};

}  // namespace

SimulatedRun SimulateShaft(const ShaftRun& run) {
  if (!(run.sd.minCoeff() > 0.0)) {
    throw InputError(fmt::format(
        "{}: the noise of the sensors is not known; state u_gap_um in the header", run.name));
  }
  estimation::ParameterBlock zeros(fmt::format("rim_zero {}", run.name), {"um", 1e-6}, {});
  for (int sensor = 0; sensor < run.rim.sensors; ++sensor) {
    zeros.entries.push_back(
        {.name = fmt::format("sensor_{}", sensor + 1), .prior_sd = estimation::kNoPrior});
  }
  const auto residual = std::make_shared<RimResidual>(run);
  SimulatedRun simulated{run.name, "shaft", {std::move(zeros)}, residual};
  simulated.response = residual;
  return simulated;
}

Trace TraceOf(const recording::Recording& recording, const ShaftRun& run) {
  Trace trace;
  trace.name = run.name;
  trace.started = StartedOf(recording);
  trace.time = trace.clock = run.time;
  trace.pass = run.turn;
  trace.direction.assign(run.turn.size(), 1);
  trace.axes = trace.velocity = trace.acceleration = trace.heading =
      Eigen::Matrix3Xd::Zero(3, run.rows());
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, run.rows(), kLongAgo);
  trace.rim = run.rim;
  return trace;
}

}  // namespace abbe::simulation
