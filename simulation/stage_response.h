// What disturbances do to a run whose rows each follow the stages of their own instant alone.
//
// `by_stage`: derivative of what is simulated by each stage (simulation/disturbance.h), whitened;
// residual rows x stages, `per_instant` rows of the residual for each row of the run, one instant
// after the other. Stages beyond its columns do nothing. For use within simulation/ only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/simulated_run.h"

namespace abbe::simulation {

class StageResponse : public Response {
 public:
  StageResponse(Eigen::MatrixXd by_stage, Eigen::Index per_instant);

  Eigen::MatrixXd Columns(const std::vector<Disturbance>& disturbances) const override;
  // Nothing, unless a run says otherwise.
  Eigen::MatrixXd Readings(const Eigen::VectorXd&) const override { return {}; }
  // Only sorted, the derivatives being whitened: the first row of all instants, the second, ...
  Eigen::MatrixXd BackToReadings(const Eigen::MatrixXd& left) const override;
  Eigen::MatrixXd BackToStage(Eigen::Index stage, const Eigen::MatrixXd& back) const override;
  Eigen::RowVectorXd WeightsOf(Eigen::Index stage) const override;
  bool RowsAreIndependent() const override { return true; }

 protected:
  const Eigen::MatrixXd& by_stage() const { return by_stage_; }
  Eigen::Index per_instant() const { return per_instant_; }
  Eigen::Index instants() const { return by_stage_.rows() / per_instant_; }

 private:
  Eigen::MatrixXd by_stage_;
  Eigen::Index per_instant_;
};

}  // namespace abbe::simulation
